#include "client/cli/commands/drag_loop.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"

namespace arap::cli {
namespace {

// Sequences grow from 1: two for each frame, the edit before it and its update.
constexpr std::uint64_t EditSequence(std::size_t frame) { return 2 * frame + 1; }
constexpr std::uint64_t UpdateSequence(std::size_t frame) { return 2 * frame + 2; }

using Clock = std::chrono::steady_clock;

double MicrosSince(Clock::time_point then) {
  return std::chrono::duration<double, std::micro>(Clock::now() - then).count();
}

// A shape and what it answers.
struct Answer {
  DragCue cue;
  client::Shape shape;
};

auto NotAsked() {
  return Fail(FaultKind::kInternal, "The server answered something that was not asked.");
}

auto EndedEarly() { return Fail(FaultKind::kInternal, "The server ended the stream early."); }

// What the answers of a drag amount to.
class Tally {
 public:
  Tally(const DragScript& script, const DragEvents& events) : script_(script), events_(events) {}

  void Sent(std::size_t updates) { times_.sent += updates; }
  void Resumed(const client::Resumed& resumed);
  // The answers in the order of the script.
  Status Count(Answer answer, double round_trip_micros);
  // There are no more.
  DragTimes Take() {
    Close(0);
    return std::move(times_);
  }

 private:
  void Close(std::size_t lost);

  const DragScript& script_;
  const DragEvents& events_;
  DragTimes times_;
  std::size_t next_ = 0;        // the frame after the last that was answered
  std::optional<DragGap> gap_;  // since then
};

void Tally::Resumed(const client::Resumed& resumed) {
  if (!gap_) gap_.emplace();
  if (next_ > 0) gap_->after = next_ - 1;
  ++gap_->losses;
  gap_->attempts += resumed.attempts;
  ++times_.resumed;
}

void Tally::Close(std::size_t lost) {
  if (!gap_) return;
  gap_->lost = lost;
  times_.lost += lost;
  events_.on_gap(*gap_);
  gap_.reset();
}

Status Tally::Count(Answer answer, double round_trip_micros) {
  const client::Shape& shape = answer.shape;
  const std::size_t frame = answer.cue.frame;
  if (answer.cue.edit) {
    const TrackEdit& edit = *script_.EditAt(frame);
    times_.edits.push_back({frame, edit.remove.size(), edit.add.size(), shape.queue_micros,
                            shape.solve_micros, round_trip_micros});
    return {};
  }
  // Those between have no answer: newer ones took their place, on the server or, while the stream
  // was lost, in the client library.
  const std::size_t skipped = frame - next_;
  if (gap_) {
    Close(skipped);
  } else {
    times_.replaced += skipped;
  }
  next_ = frame + 1;
  ++times_.answered;
  times_.round_trip_micros.push_back(round_trip_micros);
  times_.queue_micros.push_back(shape.queue_micros);
  times_.solve_micros.push_back(shape.solve_micros);
  times_.flips.Add(shape.quality);
  times_.worst_handle_error = std::max(times_.worst_handle_error, shape.quality.worst_handle_error);
  if (!shape.picks.empty()) times_.picks = std::move(answer.shape.picks);
  return events_.on_shape(frame, std::move(answer.shape));
}

// The answers of a stream in the order of the script, each of them once. Losses go to the tally.
class Answers {
 public:
  Answers(client::DeformStream& stream, const DragScript& script, Tally& tally)
      : stream_(stream), script_(script), tally_(tally) {}

  // Empty at the end of the stream. Anything but an answer is a fault.
  Result<std::optional<Answer>> Next() {
    std::optional<client::StreamEvent> event;
    for (const client::Resumed* resumed = nullptr;;) {
      TRY(event, stream_.Read());
      if (!event) return std::optional<Answer>();
      resumed = std::get_if<client::Resumed>(&*event);
      if (resumed == nullptr) break;
      tally_.Resumed(*resumed);
    }
    if (auto* error = std::get_if<client::UpdateError>(&*event)) {
      if (const auto cue = script_.CueOf(error->sequence)) {
        error->fault.message = fmt::format("{} {}: {}", cue->edit ? "edit before frame" : "frame",
                                           cue->frame, error->fault.message);
        return Fail(InOwnWords(std::move(error->fault), script_.OriginsOf(*cue)));
      }
      return Fail(error->fault);
    }
    auto* shape = std::get_if<client::Shape>(&*event);
    if (shape == nullptr || shape->sequence <= last_) return NotAsked();
    last_ = shape->sequence;
    const std::optional<DragCue> cue = script_.CueOf(shape->sequence);
    const bool last = cue && !cue->edit && cue->frame + 1 == script_.frame_count();
    if (!cue || shape->picks.size() != (last ? script_.pick_points().size() : 0)) {
      return NotAsked();
    }
    return std::optional<Answer>({*cue, std::move(*shape)});
  }

  // Whether the last frame has its answer, which no newer update can replace.
  bool HasAll() const {
    const std::size_t frames = script_.frame_count();
    return frames == 0 || last_ == UpdateSequence(frames - 1);
  }

 private:
  client::DeformStream& stream_;
  const DragScript& script_;
  Tally& tally_;
  std::uint64_t last_ = 0;  // its sequence
};

// Whether it neither turns nor scales a handle.
bool IsPlain(const TrackFrame& frame) {
  return std::all_of(frame.targets.begin(), frame.targets.end(),
                     [](const Target& target) { return target.angle == 0 && target.scale == 1; });
}

}  // namespace

DragScript::DragScript(const Stage& stage, bool hard, std::vector<Complex> pick_points)
    : stage_(stage),
      track_(stage.track()),
      hard_(hard),
      pick_points_(std::move(pick_points)),
      packed_(track_.edits.empty() &&
              std::all_of(track_.frames.begin(), track_.frames.end(), IsPlain)) {}

std::vector<Origin> DragScript::OriginsOf(const DragCue& cue) const {
  if (!cue.edit) {
    return {stage_.InTrack("targets", "the target", {"frames", cue.frame, "targets"})};
  }
  const auto number = static_cast<std::size_t>(EditAt(cue.frame) - track_.edits.data());
  return {stage_.InTrack("add", "the handle", {"edits", number, "add"}),
          stage_.InTrack("remove", "the name", {"edits", number, "remove"})};
}

Status DragScript::SendEdit(client::DeformStream& stream, std::size_t frame) const {
  const TrackEdit* const edit = EditAt(frame);
  if (edit == nullptr) return {};
  return stream.Edit(EditSequence(frame), edit->remove, ToHandles(track_, edit->add, hard_));
}

Status DragScript::SendUpdate(client::DeformStream& stream, std::size_t frame,
                              TrackSegments& segments) const {
  client::HandleUpdate update;
  update.sequence = UpdateSequence(frame);
  if (frame + 1 == frame_count()) update.pick_points = pick_points_;
  const std::vector<Target>& targets = track_.frames[frame].targets;
  if (packed_) {
    for (const Target& target : targets) update.positions.push_back(target.position);
    return stream.Send(update);
  }
  // By id: whatever order an edit leaves the handles in, each goes where the frame says.
  const std::vector<std::string>& ids = segments.At(frame).ids;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    update.targets.push_back({ids[k], targets[k]});
  }
  return stream.Send(update);
}

std::optional<DragCue> DragScript::CueOf(std::uint64_t sequence) const {
  if (sequence < 1 || sequence > 2 * frame_count()) return std::nullopt;
  const DragCue cue{(sequence - 1) / 2, sequence % 2 == 1};
  if (cue.edit && EditAt(cue.frame) == nullptr) return std::nullopt;
  return cue;
}

Result<DragTimes> DragEvery(client::DeformStream& stream, const DragScript& script,
                            const DragEvents& events) {
  Tally tally(script, events);
  Answers answers(stream, script, tally);
  TrackSegments segments(script.track());
  const auto ask = [&](std::size_t frame, bool edit) -> Status {
    const Clock::time_point sent = Clock::now();
    // A failed send is explained by the read.
    (void)(edit ? script.SendEdit(stream, frame) : script.SendUpdate(stream, frame, segments));
    TRY(std::optional<Answer> answer, answers.Next());
    if (!answer) return EndedEarly();
    if (answer->cue.frame != frame || answer->cue.edit != edit) return NotAsked();
    return tally.Count(*std::move(answer), MicrosSince(sent));
  };
  for (std::size_t i = 0; i < script.frame_count(); ++i) {
    if (script.EditAt(i) != nullptr) CHECK_OK(ask(i, /*edit=*/true));
    tally.Sent(1);
    CHECK_OK(ask(i, /*edit=*/false));
  }
  return tally.Take();
}

Result<DragTimes> DragLatest(client::DeformStream& stream, const DragScript& script, double rate,
                             const DragEvents& events) {
  const Clock::time_point start = Clock::now();
  const auto due = [&](std::size_t frame) {
    const std::chrono::duration<double> after(static_cast<double>(frame) / rate);
    return start + std::chrono::duration_cast<Clock::duration>(after);
  };
  const std::jthread writer([&](const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any wake;  // by the stop alone
    TrackSegments segments(script.track());
    for (std::size_t i = 0; i < script.frame_count() && !stop.stop_requested(); ++i) {
      std::unique_lock lock(mutex);
      wake.wait_until(lock, stop, due(i), [] { return false; });
      if (stop.stop_requested() || !script.SendEdit(stream, i) ||
          !script.SendUpdate(stream, i, segments)) {
        break;
      }
    }
  });
  Tally tally(script, events);
  tally.Sent(script.frame_count());
  const Status read = [&]() -> Status {
    for (Answers answers(stream, script, tally);;) {
      if (answers.HasAll()) (void)stream.CloseSending();
      TRY(std::optional<Answer> answer, answers.Next());
      if (!answer) {
        if (answers.HasAll()) return {};
        return EndedEarly();
      }
      const double late = MicrosSince(due(answer->cue.frame));
      CHECK_OK(tally.Count(*std::move(answer), late));
    }
  }();
  if (read) return tally.Take();
  stream.Cancel();  // frees a writer that waits for the server to read
  return Fail(read.error());
}

}  // namespace arap::cli
