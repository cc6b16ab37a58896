// Plays a track through a live stream and takes the times.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "arap/base/result.h"
#include "arap/client/session.h"
#include "client/cli/commands/drag_script.h"
#include "client/cli/commands/edit_times.h"

namespace arap::cli {

struct DragTimes {
  std::vector<double> round_trip_micros;  // per answer
  std::vector<double> queue_micros;
  std::vector<double> solve_micros;
  std::size_t sent = 0;
  std::size_t answered = 0;
  std::size_t replaced = 0;  // by newer updates, in LATEST delivery
  std::size_t frames_with_flips = 0;
  std::size_t most_flips = 0;  // in one frame
  double worst_handle_error = 0;
  std::vector<EditTimes> edits;           // in order
  std::vector<client::PickResult> picks;  // of the script's points, on the last frame
};

// Called for every frame that is answered, in order, on the calling thread.
using OnShape = std::function<void(std::size_t frame, const client::Shape& shape)>;

// EVERY delivery: each update, and each edit, is sent when the one before is answered. The round
// trip is counted from the sending.
Result<DragTimes> DragEvery(client::DeformStream& stream, const DragScript& script,
                            const OnShape& on_shape);

// LATEST delivery: `rate` updates a second (above 0), whatever the server does. The round trip is
// counted from when an update, or the one after an edit, was due, so a late sender does not flatter
// it.
Result<DragTimes> DragLatest(client::DeformStream& stream, const DragScript& script, double rate,
                             const OnShape& on_shape);

}  // namespace arap::cli
