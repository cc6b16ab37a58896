#include "core/files/track.h"

#include <algorithm>
#include <string_view>
#include <unordered_set>
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

const TrackEdit* EditBefore(const Track& track, std::size_t frame) {
  const auto edit =
      std::lower_bound(track.edits.begin(), track.edits.end(), frame,
                       [](const TrackEdit& each, std::size_t f) { return each.frame < f; });
  return edit != track.edits.end() && edit->frame == frame ? &*edit : nullptr;
}

TrackSegments::TrackSegments(const Track& track) : track_(track) {
  Append(track.handles);
  segment_.end = track.frames.size();
  if (track.edits.empty()) return;
  if (track.edits.front().frame == 0) {
    Edit();
  } else {
    segment_.end = track.edits.front().frame;
  }
}

bool TrackSegments::Next() {
  if (edits_ == track_.edits.size()) return false;
  Edit();
  return true;
}

const TrackSegment& TrackSegments::At(std::size_t frame) {
  while (frame >= segment_.end && Next()) {
  }
  return segment_;
}

void TrackSegments::Append(const std::vector<TrackHandle>& entries) {
  for (const TrackHandle& entry : entries) {
    segment_.ids.push_back(entry.handle.id);
    segment_.numbers.push_back(number_++);
  }
}

void TrackSegments::Edit() {
  const TrackEdit& edit = track_.edits[edits_++];
  segment_.edit = &edit;
  segment_.first = edit.frame;
  segment_.end = edits_ < track_.edits.size() ? track_.edits[edits_].frame : track_.frames.size();
  std::unordered_set<std::string_view> removed(edit.remove.begin(), edit.remove.end());
  std::size_t kept = 0;
  for (std::size_t k = 0; k < segment_.ids.size(); ++k) {
    if (!removed.empty() && removed.erase(segment_.ids[k]) > 0) continue;
    if (kept < k) segment_.ids[kept] = std::move(segment_.ids[k]);
    segment_.numbers[kept++] = segment_.numbers[k];
  }
  segment_.ids.resize(kept);
  segment_.numbers.resize(kept);
  Append(edit.add);
}

}  // namespace arap
