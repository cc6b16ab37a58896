#include "server/streams/stream_policy.h"

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "arap/core/cost.h"
#include "core/base/try.h"
#include "server/budget/faults.h"

namespace arap::app {
namespace {

// An edit of more handles than these, or of one with an area, is a job whatever is expected of it.
constexpr std::size_t kLightEdit = 4;

Fault Protocol(const char* message) { return Fault(FaultKind::kProtocol, message); }

StreamJob::Lane LaneOf(double seconds) {
  return seconds > kLongFrameSeconds ? StreamJob::Lane::kJobs : StreamJob::Lane::kFrames;
}

double PickSeconds(const CompiledHandles& handles, std::size_t picks) {
  if (picks == 0) return 0;
  return EstimateFrame(handles, {}, picks).seconds() - EstimateFrame(handles, {}).seconds();
}

StreamAnswer Shape(std::uint64_t sequence, std::unique_ptr<WireAnswer> message) {
  StreamAnswer answer;
  answer.kind = StreamAnswer::Kind::kShape;
  answer.sequence = sequence;
  answer.message = std::move(message);
  return answer;
}

}  // namespace

StreamPolicy::StreamPolicy(const Limits& limits, const runtime::Clock& clock, Admit admit)
    : limits_(limits),
      clock_(clock),
      admit_(std::move(admit)),
      heard_(clock.SteadyNow()),
      rate_(limits.max_stream_fps, heard_) {}

void StreamPolicy::MessageRead(StreamMessage message) {
  reading_ = false;
  heard_ = clock_.SteadyNow();
  held_ = std::move(message);
  held_fault_.reset();
}

void StreamPolicy::HalfClosed() {
  reading_ = false;
  heard_ = clock_.SteadyNow();
  reads_done_ = true;
}

void StreamPolicy::Written(bool ok) {
  writing_ = false;
  if (!ok) cancelled_ = true;
}

void StreamPolicy::Cancelled() { cancelled_ = true; }

void StreamPolicy::End(Fault reason) {
  if (ending()) return;
  end_ = std::move(reason);
  ended_ = clock_.SteadyNow();
}

bool StreamPolicy::Sweep(runtime::Clock::Steady now) {
  if (end_) return writing_ && !cancelled_ && now - ended_ >= kLastWrite;
  const auto limit = limits_.max_stream_idle;
  if (limit.count() <= 0 || now - heard_ < limit || ending()) return false;
  const auto seconds = fmt::format("{:g}", std::chrono::duration<double>(limit).count());
  End(Fault(FaultKind::kStreamIdle,
            fmt::format("Nothing was said on this stream for {} s; send a ping now and then.",
                        seconds))
          .Detail("quota", "max_stream_idle")
          .Detail("limit", seconds));
  return writing_;
}

StreamStep StreamPolicy::Next() {
  if (finished_) return {};
  if (ending()) {
    held_.reset();
    next_.reset();
  }
  if (cancelled_) outbox_.Clear();
  if (held_ && !ending() && Take()) {
    held_.reset();
    if (start_) return *std::exchange(start_, std::nullopt);
  }
  if (!reading_ && !held_ && !reads_done_ && !ending() && !outbox_.pong_waits()) {
    reading_ = true;
    return StreamRead{};
  }
  if (auto job = Begin()) return *std::move(job);
  if (!writing_ && !cancelled_) {
    if (auto answer = outbox_.Pop()) {
      if (answer->kind == StreamAnswer::Kind::kShape) ++counts_.shapes;
      if (answer->kind == StreamAnswer::Kind::kError) ++counts_.errors;
      counts_.replaced += answer->replaced;
      writing_ = true;
      return StreamWrite{*std::move(answer)};
    }
  }
  if (auto status = Over()) {
    finished_ = true;
    return StreamFinish{*std::move(status)};
  }
  return {};
}

std::optional<Status> StreamPolicy::Over() const {
  if (writing_ || work_) return std::nullopt;
  if (cancelled_) return Fail(FaultKind::kCancelled, "The caller has cancelled.");
  if (end_) return Fail(*end_);
  if (!reads_done_ || held_ || next_) return std::nullopt;
  if (!opened_) return Fail(FaultKind::kProtocol, "The stream ended before it was opened.");
  return Status();
}

bool StreamPolicy::Take() {
  if (held_->bytes > limits_.max_message_bytes) {
    End(TooLarge("The message", "max_message_bytes", held_->bytes, limits_.max_message_bytes));
    return true;
  }
  auto& payload = held_->payload;
  if (std::holds_alternative<std::monostate>(payload)) {
    End(Protocol("A message without payload: give open, update, edit or ping."));
    return true;
  }
  if (opened_ == std::holds_alternative<StreamMessage::Open>(payload)) {
    End(Protocol(opened_ ? "The stream is open already: open comes only once."
                         : "The first message of a stream must be open."));
    return true;
  }
  if (auto* update = std::get_if<StreamMessage::Update>(&payload)) return TakeUpdate(*update);
  if (auto* edit = std::get_if<StreamMessage::Edit>(&payload)) return TakeEdit(*edit);
  if (auto* ping = std::get_if<StreamMessage::Ping>(&payload)) {
    outbox_.SetPong(ping->nonce);
    return true;
  }
  opened_ = true;
  StreamJob job;
  job.work = StreamJob::Work::kOpen;
  job.lane = StreamJob::Lane::kControl;
  Start(std::move(job));
  return true;
}

bool StreamPolicy::TakeUpdate(StreamMessage::Update& update) {
  using Work = StreamJob::Work;
  if ((work_ && *work_ != Work::kUpdate) || (!latest_ && next_)) return false;
  if (auto alive = touch_(); !alive) {
    End(std::move(alive.error()));
    return true;
  }
  if (!granted_) {
    if (auto granted = Grant(); !granted) return RefuseInTurn(update.sequence, granted.error());
    granted_ = true;
  }
  // The targets that it is merged with stay the same for as long as it is held.
  if (!held_fault_) {
    if (auto merged = Merge(update); !merged) held_fault_ = std::move(merged.error());
  }
  if (held_fault_) return RefuseInTurn(update.sequence, *held_fault_);
  granted_ = false;
  set_.targets.swap(merged_);
  if (next_) ++replaced_;
  measure_next_ |= update.measure;
  next_ = Accepted{update.sequence, *std::move(update.picks), {}};
  return true;
}

bool StreamPolicy::TakeEdit(const StreamMessage::Edit& edit) {
  if (!idle()) return false;
  if (auto alive = touch_(); !alive) {
    End(std::move(alive.error()));
    return true;
  }
  StreamJob job;
  job.work = StreamJob::Work::kEdit;
  // A handle holds three rows at most, unless it has an area.
  const std::size_t vertices = set_.handles->mesh()->mesh().vertices.size();
  const RowCount added{.rows = edit.has_areas ? vertices : 3 * edit.added};
  job.seconds = EstimateEdit(*set_.handles, {}, added).cost.seconds() + pace_->frame_seconds();
  job.lane =
      edit.added <= kLightEdit && !edit.has_areas ? LaneOf(job.seconds) : StreamJob::Lane::kJobs;
  job.sequence = edit.sequence;
  job_targets_ = set_.targets;
  job.targets = job_targets_;
  Start(std::move(job));
  return true;
}

bool StreamPolicy::RefuseInTurn(std::uint64_t sequence, const Fault& fault) {
  if (!idle()) return false;  // its turn comes after the answers before it
  granted_ = false;
  Refuse(sequence, fault);
  return true;
}

Status StreamPolicy::Grant() {
  const auto now = clock_.SteadyNow();
  if (!rate_.Take(now)) {
    return Fail(QuotaFull("max_stream_fps", static_cast<std::size_t>(limits_.max_stream_fps)));
  }
  if (pace_->Asleep(now)) {
    CHECK_OK(admit_.wake_up(pace_->Share()));
    said_awake_ = now;
  } else if (now - said_awake_ >= kAwake / 3) {
    admit_.stays_awake(pace_->Share());
    said_awake_ = now;
  }
  pace_->Update(now);
  return {};
}

Status StreamPolicy::Merge(const StreamMessage::Update& update) {
  if (!update.picks) return Fail(update.picks.error());
  const bool packed = !update.positions.empty();
  if (packed && !update.targets.empty()) {
    return Fail(
        Fault(FaultKind::kInvalidOption, "An update has either targets or positions, not both.")
            .Field("positions"));
  }
  merged_ = set_.targets;
  CHECK_OK(packed ? PackedTargets(*set_.handles, update.positions, merged_)
                  : MergeTargets(*set_.handles, update.targets, merged_));
  return set_.handles->CheckHard(merged_);
}

bool StreamPolicy::Measures() {
  const bool due = measure_every_ > 0 && unmeasured_ + 1 >= measure_every_;
  const bool measures = std::exchange(measure_next_, false) || due || outbox_.replaces_measured();
  unmeasured_ = measures || measure_every_ == 0 ? 0 : unmeasured_ + 1;
  return measures;
}

std::optional<StreamJob> StreamPolicy::Begin() {
  if (work_ || !next_ || ending()) return std::nullopt;
  if (!outbox_.empty() && !(latest_ && outbox_.replaceable())) return std::nullopt;
  StreamJob job;
  job.work = StreamJob::Work::kUpdate;
  job.sequence = next_->sequence;
  job.picks = std::move(next_->picks);
  job.seconds = pace_->frame_seconds() + PickSeconds(*set_.handles, job.picks.size());
  job.lane = LaneOf(job.seconds);
  job.waiting = next_->waiting;
  job.measure = job_measured_ = Measures();
  job_targets_ = set_.targets;
  job.targets = job_targets_;
  job_replaced_ = std::exchange(replaced_, 0);
  next_.reset();
  Start(std::move(job));
  return std::exchange(start_, std::nullopt);
}

void StreamPolicy::Start(StreamJob job) {
  work_ = job.work;
  job_sequence_ = job.sequence;
  start_ = std::move(job);
}

void StreamPolicy::Refuse(std::uint64_t sequence, Fault fault) {
  StreamAnswer answer;
  answer.kind = StreamAnswer::Kind::kError;
  answer.sequence = sequence;
  answer.fault = std::move(fault);
  outbox_.Push(std::move(answer));
}

void StreamPolicy::NoRoom() { Failed(Overloaded()); }

Status StreamPolicy::AdmitFrames(double frame_seconds) {
  pace_.emplace(frame_seconds);
  return admit_.may_open(pace_->Share());
}

void StreamPolicy::Opened(LiveHandles set, bool latest, std::uint32_t measure_every, Touch touch,
                          std::unique_ptr<WireAnswer> answer) {
  set_ = std::move(set);
  latest_ = latest;
  measure_every_ = measure_every;
  measure_next_ = measure_every > 0;
  touch_ = std::move(touch);
  StreamAnswer opened;
  opened.message = std::move(answer);
  outbox_.Push(std::move(opened));
  work_.reset();
}

void StreamPolicy::Moved(std::unique_ptr<WireAnswer> shape) {
  StreamAnswer answer = Shape(job_sequence_, std::move(shape));
  answer.replaced = std::exchange(job_replaced_, 0);
  answer.measured = job_measured_;
  outbox_.PushUpdate(std::move(answer), latest_);
  work_.reset();
}

void StreamPolicy::Edited(LiveHandles set, std::unique_ptr<WireAnswer> shape) {
  set_ = std::move(set);
  unmeasured_ = 0;
  measure_next_ = false;
  outbox_.Push(Shape(job_sequence_, std::move(shape)));
  work_.reset();
}

void StreamPolicy::Failed(Fault fault) {
  if (work_ == StreamJob::Work::kOpen) {
    End(std::move(fault));
  } else {
    replaced_ += std::exchange(job_replaced_, 0);
    if (work_ == StreamJob::Work::kUpdate) measure_next_ |= job_measured_;
    Refuse(job_sequence_, std::move(fault));
  }
  work_.reset();
}

}  // namespace arap::app
