// What a stream does with its messages: opening, updates, edits.
#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/rpc/cancel.h"
#include "server/rpc/convert_handles.h"
#include "server/rpc/stream_deform_reactor.h"
#include "server/sessions/names.h"
#include "server/sessions/warm.h"
#include "server/streams/targets.h"

namespace arap::rpc {
namespace {

// An edit of at most this many handles, none of them with an area, costs about as much as a few
// updates.
constexpr int kLightEdit = 4;

bool IsLight(const v1::HandleEdit& edit) {
  return edit.add_size() <= kLightEdit &&
         std::all_of(edit.add().begin(), edit.add().end(),
                     [](const v1::Handle& handle) { return handle.area_radius() == 0; });
}

Fault Protocol(const char* message) { return Fault(FaultKind::kProtocol, message); }

}  // namespace

bool StreamDeformReactor::TakeMessage() {
  using Request = v1::StreamDeformRequest;
  const std::size_t most = engine_.limits.max_message_bytes;
  if (const std::size_t bytes = incoming_.ByteSizeLong(); bytes > most) {
    EndLocked(app::TooLarge("The message", "max_message_bytes", bytes, most));
    return true;
  }
  const auto payload = incoming_.payload_case();
  if (payload == Request::PAYLOAD_NOT_SET) {
    EndLocked(Protocol("A message without payload: give open, update, edit or ping."));
    return true;
  }
  if (opened_ != (payload != Request::kOpen)) {
    EndLocked(Protocol(opened_ ? "The stream is open already: open comes only once."
                               : "The first message of a stream must be open."));
    return true;
  }
  switch (payload) {
    case Request::kOpen:
      TakeOpen();
      return true;
    case Request::kUpdate:
      return TakeUpdate(incoming_.update());
    case Request::kEdit:
      return TakeEdit(*incoming_.mutable_edit());
    case Request::kPing:
      outbox_.SetPong(incoming_.ping().nonce());
      return true;
    case Request::PAYLOAD_NOT_SET:
      break;
  }
  return true;
}

bool StreamDeformReactor::Post(runtime::WorkerPool& lane, void (StreamDeformReactor::*job)()) {
  job_waiting_ = {};
  auto run = [self = shared_from_this(), job] { (self.get()->*job)(); };
  // Whoever was let in does not wait, and is not refused, because of the calls of others.
  return &lane == &engine_.interactive ? lane.PostUrgent(std::move(run))
                                       : lane.TryPost(std::move(run));
}

void StreamDeformReactor::TakeOpen() {
  opened_ = true;
  job_open_ = std::move(*incoming_.mutable_open());
  log_.Opened(job_open_.session_id());
  work_ = Work::kOpen;
  if (Post(engine_.control, &StreamDeformReactor::RunFind)) return;
  work_ = Work::kNone;
  EndLocked(app::Overloaded());
}

bool StreamDeformReactor::TakeUpdate(const v1::HandleUpdate& update) {
  if (work_ == Work::kOpen || work_ == Work::kEdit || (!latest_ && next_)) return false;
  if (auto alive = session_->Touch(); !alive) {
    EndLocked(std::move(alive.error()));
    return true;
  }
  if (!granted_) {
    if (auto granted = Grant(engine_.clock.SteadyNow()); !granted) {
      if (!idle()) return false;
      Refuse(update.sequence(), granted.error());
      return true;
    }
    granted_ = true;
  }
  auto picks = PicksFromWire(update.pick_points());
  const Status merged = picks ? Merge(update) : Status(Fail(picks.error()));
  if (!merged) {
    if (!idle()) return false;  // its turn comes after the answers before it
    granted_ = false;
    Refuse(update.sequence(), merged.error());
    return true;
  }
  granted_ = false;
  if (next_) ++replaced_;
  next_ = Accepted{update.sequence(), {}, *std::move(picks)};
  return true;
}

Status StreamDeformReactor::Grant(runtime::Clock::Steady now) {
  if (!rate_.Take(now)) {
    const auto limit = static_cast<std::size_t>(engine_.limits.max_stream_fps);
    return Fail(app::QuotaFull("max_stream_fps", limit));
  }
  if (pace_->Asleep(now)) {
    if (auto admitted = Admit(now); !admitted) return admitted;
  }
  pace_->Update(now);
  return {};
}

Status StreamDeformReactor::Admit(runtime::Clock::Steady now) {
  return engine_.load.Admit(pace_->Share(), engine_.interactive.stats().busy, now);
}

void StreamDeformReactor::Refuse(std::uint64_t sequence, const Fault& fault) {
  CountRefusal(fault, engine_.metrics);
  outbox_.PushError(sequence, fault);
}

Status StreamDeformReactor::Merge(const v1::HandleUpdate& update) {
  const bool packed = update.positions_size() > 0;
  if (packed && update.targets_size() > 0) {
    return Fail(
        Fault(FaultKind::kInvalidOption, "An update has either targets or positions, not both.")
            .Field("positions"));
  }
  const CompiledHandles& handles = live_->handles();
  std::vector<Target> targets = live_->targets();
  const std::span positions(update.positions().data(),
                            static_cast<std::size_t>(update.positions_size()));
  Status good = packed ? app::PackedTargets(handles, positions, targets)
                       : app::MergeTargets(handles, FromWire(update.targets()), targets);
  if (good) good = handles.CheckHard(targets);
  if (good) live_->targets() = std::move(targets);
  return good;
}

bool StreamDeformReactor::TakeEdit(v1::HandleEdit& edit) {
  if (!idle()) return false;
  if (auto alive = session_->Touch(); !alive) {
    EndLocked(std::move(alive.error()));
    return true;
  }
  job_edit_ = std::move(edit);
  work_ = Work::kEdit;
  if (!Post(IsLight(job_edit_) ? engine_.interactive : engine_.jobs,
            &StreamDeformReactor::RunEdit)) {
    work_ = Work::kNone;
    Refuse(job_edit_.sequence(), app::Overloaded());
  }
  return true;
}

bool StreamDeformReactor::Begin() {
  if (work_ != Work::kNone || !next_ || ending()) return false;
  if (!outbox_.empty() && !(latest_ && outbox_.replaceable())) return false;
  job_update_ = *std::exchange(next_, std::nullopt);
  job_targets_ = live_->targets();
  job_replaced_ = std::exchange(replaced_, 0);
  work_ = Work::kUpdate;
  if (!Post(engine_.interactive, &StreamDeformReactor::RunUpdate)) {
    work_ = Work::kNone;
    replaced_ = job_replaced_;
    Refuse(job_update_.sequence, app::Overloaded());
  }
  return true;
}

Status StreamDeformReactor::FindSession() {
  auto session = engine_.sessions.Use(caller_.owner, job_open_.session_id());
  if (!session) return Fail(std::move(session.error()));
  session_ = *std::move(session);
  return {};
}

// The store may be slow and what was evicted has to be computed again: neither on the lane of
// frames.
void StreamDeformReactor::RunFind() {
  const Status found = FindSession();
  if (found && app::IsWarmHandleSet(engine_, *session_, job_open_.handle_set_id())) {
    return RunOpen();
  }
  if (found && Post(engine_.jobs, &StreamDeformReactor::RunOpen)) return;
  const std::lock_guard lock(mutex_);
  EndLocked(found ? app::Overloaded() : found.error());
  work_ = Work::kNone;
  Pump();
}

Result<app::LiveSet> StreamDeformReactor::OpenSet() {
  auto entry = app::WarmHandleSet(engine_, caller_, *session_, job_open_.handle_set_id(),
                                  CancelTokenOf(context_));
  if (!entry) return Fail(std::move(entry.error()));
  auto options = FromWire(job_open_.options(), engine_.limits);
  if (!options) return Fail(std::move(options.error()));
  if (!v1::Delivery_IsValid(job_open_.delivery())) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      "open.delivery has a value that this version does not know.")
                    .Field("open.delivery")
                    .Detail("value", std::to_string(job_open_.delivery())));
  }
  const std::size_t vertices = entry->handles->mesh()->mesh().vertices.size();
  const auto refine = static_cast<std::size_t>(options->deform.refine);
  const auto now = engine_.clock.SteadyNow();
  pace_.emplace(app::FrameSeconds(vertices, refine), now);
  if (auto admitted = Admit(now); !admitted) return Fail(std::move(admitted.error()));
  options_ = *options;
  latest_ = job_open_.delivery() != v1::DELIVERY_EVERY;
  end_listener_ = session_->AddEndListener(
      [weak = weak_from_this(), ended = app::NotFound("session", job_open_.session_id())] {
        if (const auto self = weak.lock()) self->End(ended);
      });
  return app::LiveSet(*std::move(entry));
}

void StreamDeformReactor::RunOpen() {
  // Nothing else looks at the members that OpenSet sets before work_ changes.
  auto live = OpenSet();
  v1::StreamDeformResponse message;
  if (live) ToWire(live->entry(), message.mutable_opened()->mutable_handle_set());

  const std::lock_guard lock(mutex_);
  if (live) {
    live_.emplace(*std::move(live));
    outbox_.Push(std::move(message));
  } else {
    EndLocked(std::move(live.error()));
  }
  work_ = Work::kNone;
  Pump();
}

void StreamDeformReactor::RunUpdate() {
  const double queue_micros = job_update_.waiting.Micros();
  const runtime::Stopwatch working;
  v1::StreamDeformResponse message;
  auto quality = live_->deformer().Update(job_targets_, options_.deform);
  const Status made =
      quality ? Fill(live_->deformer(), *quality, job_update_.sequence, live_->entry().revision,
                     working, queue_micros, message.mutable_shape())
              : Status(Fail(std::move(quality.error())));
  if (made) {
    engine_.metrics.Phase(runtime::Phase::kFrame, message.shape().solve_micros() * 1e-6);
    PicksToWire(live_->deformer(), job_update_.picks, message.mutable_shape());
  }

  const std::lock_guard lock(mutex_);
  if (made) {
    message.mutable_shape()->set_replaced(job_replaced_);
    outbox_.PushUpdate(std::move(message), latest_);
  } else {
    replaced_ += job_replaced_;
    Refuse(job_update_.sequence, made.error());
  }
  work_ = Work::kNone;
  Pump();
}

void StreamDeformReactor::RunEdit() {
  const double queue_micros = job_waiting_.Micros();
  const runtime::Stopwatch working;
  v1::StreamDeformResponse message;
  ShapeQuality quality;
  auto edited = FromWire(job_edit_.add(), "add").and_then([&](const std::vector<Handle>& add) {
    return live_->Edited({job_edit_.remove().begin(), job_edit_.remove().end()}, add,
                         options_.deform, engine_.limits, CancelTokenOf(context_), quality);
  });
  const Status made =
      edited ? Fill(edited->deformer(), quality, job_edit_.sequence(), edited->entry().revision,
                    working, queue_micros, message.mutable_shape())
             : Status(Fail(std::move(edited.error())));
  if (made) engine_.metrics.Phase(runtime::Phase::kEdit, message.shape().solve_micros() * 1e-6);

  const std::lock_guard lock(mutex_);
  if (made) {
    live_.emplace(*std::move(edited));
    outbox_.Push(std::move(message));
  } else {
    Refuse(job_edit_.sequence(), made.error());
  }
  work_ = Work::kNone;
  Pump();
}

Status StreamDeformReactor::Fill(const Deformer& deformer, const ShapeQuality& quality,
                                 std::uint64_t sequence, std::uint64_t revision,
                                 const runtime::Stopwatch& working, double queue_micros,
                                 v1::Shape* shape) const {
  if (auto good = ToWire(deformer, quality, options_, shape); !good) return good;
  shape->set_sequence(sequence);
  shape->set_handle_set_revision(revision);
  shape->set_queue_micros(queue_micros);
  shape->set_solve_micros(working.Micros());
  return {};
}

}  // namespace arap::rpc
