#include "client/cli/drag_loop.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

namespace arap::cli {
namespace {

using Clock = std::chrono::steady_clock;

double MicrosSince(Clock::time_point then) {
  return std::chrono::duration<double, std::micro>(Clock::now() - then).count();
}

// Sequences start at 1, so that every one of them grows.
client::HandleUpdate UpdateOf(const Track& track, std::size_t frame) {
  client::HandleUpdate update;
  update.sequence = frame + 1;
  const TrackFrame& given = track.frames[frame];
  if (given.angles.empty() && given.scales.empty()) {
    update.positions = given.targets;
    return update;
  }
  for (std::size_t k = 0; k < track.handles.size(); ++k) {
    update.targets.push_back({track.handles[k].name, given.targets[2 * k], given.targets[2 * k + 1],
                              given.angles.empty() ? 0 : given.angles[k],
                              given.scales.empty() ? 1 : given.scales[k]});
  }
  return update;
}

// The next shape; empty at the end of the stream. Any other answer is a fault.
Result<std::optional<client::Shape>> ReadShape(client::DeformStream& stream,
                                               std::size_t frame_count) {
  Result<std::optional<client::StreamEvent>> event = stream.Read();
  if (!event) return Fail(event.error());
  if (!*event) return std::optional<client::Shape>();
  if (const auto* error = std::get_if<client::UpdateError>(&**event)) return Fail(error->fault);
  auto* shape = std::get_if<client::Shape>(&**event);
  if (shape == nullptr || shape->sequence < 1 || shape->sequence > frame_count) {
    return Fail(FaultKind::kInternal, "the server answered something that was not asked");
  }
  return std::optional<client::Shape>(std::move(*shape));
}

void Count(const client::Shape& shape, double round_trip, DragTimes& times) {
  ++times.answered;
  times.round_trip_micros.push_back(round_trip);
  times.queue_micros.push_back(shape.queue_micros);
  times.solve_micros.push_back(shape.solve_micros);
  times.replaced += shape.replaced;
  if (shape.flipped_count > 0) ++times.frames_with_flips;
  times.most_flips = std::max<std::size_t>(times.most_flips, shape.flipped_count);
  times.worst_handle_error = std::max(times.worst_handle_error, shape.worst_handle_error);
}

}  // namespace

Result<DragTimes> DragEvery(client::DeformStream& stream, const Track& track,
                            const OnShape& on_shape) {
  DragTimes times;
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    const Clock::time_point sent = Clock::now();
    // A failed send is explained by the read.
    (void)stream.Send(UpdateOf(track, i));
    ++times.sent;
    const auto shape = ReadShape(stream, track.frames.size());
    if (!shape) return Fail(shape.error());
    if (!*shape) return Fail(FaultKind::kInternal, "the server ended the stream early");
    Count(**shape, MicrosSince(sent), times);
    on_shape((*shape)->sequence - 1, **shape);
  }
  return times;
}

Result<DragTimes> DragLatest(client::DeformStream& stream, const Track& track, double rate,
                             const OnShape& on_shape) {
  DragTimes times;
  const Clock::time_point start = Clock::now();
  const auto due = [&](std::size_t frame) {
    const std::chrono::duration<double> after(static_cast<double>(frame) / rate);
    return start + std::chrono::duration_cast<Clock::duration>(after);
  };
  const std::jthread writer([&](const std::stop_token& stop) {
    for (std::size_t i = 0; i < track.frames.size() && !stop.stop_requested(); ++i) {
      std::this_thread::sleep_until(due(i));
      if (!stream.Send(UpdateOf(track, i))) break;
    }
    (void)stream.CloseSending();
  });
  times.sent = track.frames.size();
  for (;;) {
    const auto shape = ReadShape(stream, track.frames.size());
    if (!shape) {
      stream.Cancel();  // frees a writer that waits for the server to read
      return Fail(shape.error());
    }
    if (!*shape) return times;
    const std::size_t frame = (*shape)->sequence - 1;
    Count(**shape, MicrosSince(due(frame)), times);
    on_shape(frame, **shape);
  }
}

}  // namespace arap::cli
