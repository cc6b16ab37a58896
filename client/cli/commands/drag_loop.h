// Plays a track through a live stream and takes the times.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "arap/base/result.h"
#include "arap/client/deform_stream.h"
#include "arap/client/session.h"
#include "client/cli/commands/stage.h"
#include "core/files/track.h"

namespace arap::cli {

// What a sequence number stands for.
struct DragCue {
  std::size_t frame = 0;
  bool edit = false;  // the one before the frame; else the frame's update
};

// What a drag sends: for each frame of a track an update, and before some of them an edit.
// Immutable, shared by threads. Refers to the stage with the track.
class DragScript {
 public:
  // `hard`: the handles that edits add meet their targets exactly, whatever the track says.
  // `pick_points` are asked for with the last frame.
  DragScript(const Stage& stage, bool hard, std::vector<Complex> pick_points);

  std::size_t frame_count() const { return track_.frames.size(); }
  const std::vector<Complex>& pick_points() const { return pick_points_; }

  const Track& track() const { return track_; }

  // The edit before a frame, or null.
  const TrackEdit* EditAt(std::size_t frame) const { return EditBefore(track_, frame); }
  // Sends it; nothing where there is none.
  Status SendEdit(client::DeformStream& stream, std::size_t frame) const;
  // `segments` are those of the track, not beyond the frame.
  Status SendUpdate(client::DeformStream& stream, std::size_t frame, TrackSegments& segments) const;

  // Empty for a sequence that this script does not send.
  std::optional<DragCue> CueOf(std::uint64_t sequence) const;
  // Where the fields of what was sent come from.
  std::vector<Origin> OriginsOf(const DragCue& cue) const;

 private:
  const Stage& stage_;
  const Track& track_;
  bool hard_;
  std::vector<Complex> pick_points_;
  bool packed_;  // no frame turns or scales a handle: updates are positions alone
};

// A loss of the stream, or several with no shape between them, after which it went on.
struct DragGap {
  std::optional<std::size_t> after;  // the last frame that was answered before
  std::size_t losses = 0;
  std::size_t attempts = 0;  // to open the stream again, in all
  std::size_t lost = 0;      // frames that have no shape for it
};

struct DragTimes {
  std::vector<double> round_trip_micros;  // per answer
  std::vector<double> queue_micros;
  std::vector<double> solve_micros;
  std::size_t sent = 0;
  std::size_t answered = 0;
  std::size_t replaced = 0;  // by newer updates, in LATEST delivery
  std::size_t lost = 0;      // the same while the stream was lost; the three make up `sent`
  std::size_t resumed = 0;   // how often the stream was lost and went on
  Flips flips;
  double worst_handle_error = 0;
  std::vector<EditTimes> edits;            // in order
  std::vector<std::optional<Pick>> picks;  // of the script's points, on the last frame
};

// What is done on the way, on the calling thread.
struct DragEvents {
  // For every frame that is answered, in order. A fault ends the drag.
  std::function<Status(std::size_t frame, client::Shape&& shape)> on_shape;
  // For every gap, with the first frame that is answered after it, or at the end.
  std::function<void(const DragGap& gap)> on_gap;
};

// Both go on over losses of a stream that resumes.
//
// EVERY delivery: each update, and each edit, is sent when the one before is answered. The round
// trip is counted from the sending.
Result<DragTimes> DragEvery(client::DeformStream& stream, const DragScript& script,
                            const DragEvents& events);

// LATEST delivery: `rate` updates a second (above 0), whatever the server does. The round trip is
// counted from when an update, or the one after an edit, was due, so a late sender does not flatter
// it. Sending is closed when the last frame has its answer, so that until then a silent server can
// be asked for a sign of life.
Result<DragTimes> DragLatest(client::DeformStream& stream, const DragScript& script, double rate,
                             const DragEvents& events);

}  // namespace arap::cli
