// What a drag sends: for each frame of a track an update, and before some of them an edit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "arap/client/deform_stream.h"
#include "core/files/track.h"

namespace arap::cli {

// What a sequence number stands for.
struct DragCue {
  std::size_t frame = 0;
  bool edit = false;  // the one before the frame; else the frame's update
};

// Immutable, shared by threads. Refers to the track.
class DragScript {
 public:
  // `hard`: the handles that edits add meet their targets exactly, whatever the track says.
  // `pick_points`, x y x y…, are asked for with the last frame.
  DragScript(const Track& track, bool hard, std::vector<double> pick_points);

  std::size_t frame_count() const { return track_.frames.size(); }
  const std::vector<double>& pick_points() const { return pick_points_; }

  // The edit before a frame, or null.
  const TrackEdit* EditAt(std::size_t frame) const;
  // Sends it; nothing where there is none.
  Status SendEdit(client::DeformStream& stream, std::size_t frame) const;
  Status SendUpdate(client::DeformStream& stream, std::size_t frame) const;

  // Empty for a sequence that this script does not send.
  std::optional<DragCue> CueOf(std::uint64_t sequence) const;

 private:
  const Track& track_;
  bool hard_;
  std::vector<double> pick_points_;
  std::vector<TrackSegment> segments_;
};

}  // namespace arap::cli
