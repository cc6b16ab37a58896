#include "core/files/track.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace arap {

std::vector<Handle> ToHandles(const Track& track, std::span<const TrackHandle> entries, bool hard) {
  std::vector<Handle> handles;
  for (const TrackHandle& entry : entries) {
    Handle& handle = handles.emplace_back(entry.handle);
    handle.hard = hard || handle.hard;
    if (handle.hard) {
      handle.weight = Handle::kDefaultWeight;
    } else if (!entry.own_weight && track.row_weight) {
      handle.weight = *track.row_weight * *track.row_weight;
    }
  }
  return handles;
}

std::vector<Handle> ToHandles(const Track& track, bool hard) {
  return ToHandles(track, track.handles, hard);
}

std::vector<TrackSegment> SegmentsOf(const Track& track) {
  std::vector<TrackSegment> segments(1);
  std::size_t number = 0;
  const auto append = [&](const std::vector<TrackHandle>& entries) {
    for (const TrackHandle& entry : entries) {
      segments.back().ids.push_back(entry.handle.id);
      segments.back().numbers.push_back(number++);
    }
  };
  append(track.handles);
  for (const TrackEdit& edit : track.edits) {
    if (edit.frame > 0) {
      TrackSegment next = segments.back();
      segments.back().end = next.first = edit.frame;
      segments.push_back(std::move(next));
    }
    TrackSegment& segment = segments.back();
    segment.edit = &edit;
    for (const std::string& id : edit.remove) {
      const auto found = std::find(segment.ids.begin(), segment.ids.end(), id);
      if (found == segment.ids.end()) continue;
      segment.numbers.erase(segment.numbers.begin() + (found - segment.ids.begin()));
      segment.ids.erase(found);
    }
    append(edit.add);
  }
  segments.back().end = track.frames.size();
  return segments;
}

const TrackSegment& SegmentAt(std::span<const TrackSegment> segments, std::size_t frame) {
  const auto next = std::upper_bound(
      segments.begin() + 1, segments.end(), frame,
      [](std::size_t f, const TrackSegment& segment) { return f < segment.first; });
  return *std::prev(next);
}

}  // namespace arap
