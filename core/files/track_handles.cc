// The handles of a track, as the server takes them.
#include <algorithm>
#include <iterator>
#include <utility>

#include "core/files/track.h"

namespace arap::cli {

std::vector<client::Handle> ToHandles(const Track& track, std::span<const TrackHandle> entries,
                                      bool hard) {
  std::vector<client::Handle> handles;
  for (const TrackHandle& entry : entries) {
    client::Handle& handle = handles.emplace_back();
    handle.id = entry.name;
    handle.anchor = entry.anchor;
    handle.hard = hard || entry.hard;
    handle.oriented = entry.oriented;
    handle.area_radius = entry.area_radius;
    handle.snap = entry.snap;
    handle.depth = entry.depth;
    handle.depth_falloff = entry.depth_falloff;
    if (handle.hard) continue;
    if (track.row_weight) handle.weight = *track.row_weight * *track.row_weight;
    if (entry.weight) handle.weight = entry.weight;
  }
  return handles;
}

std::vector<client::Handle> ToHandles(const Track& track, bool hard) {
  return ToHandles(track, track.handles, hard);
}

std::vector<TrackSegment> SegmentsOf(const Track& track) {
  std::vector<TrackSegment> segments(1);
  std::size_t number = 0;
  const auto append = [&](const std::vector<TrackHandle>& handles) {
    for (const TrackHandle& handle : handles) {
      segments.back().ids.push_back(handle.name);
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

}  // namespace arap::cli
