// The reactor's life: reading, writing, ending. What it does with messages is in
// stream_deform_work.cc.
#include "server/rpc/stream_deform.h"

#include <utility>

#include <fmt/format.h>

#include "server/rpc/status_map.h"
#include "server/rpc/stream_deform_reactor.h"

namespace arap::rpc {

StreamDeformReactor::StreamDeformReactor(app::Engine& engine, grpc::CallbackServerContext* context,
                                         app::Caller caller)
    : engine_(engine),
      context_(context),
      caller_(std::move(caller)),
      heard_(engine.clock.SteadyNow()),
      rate_(engine.limits.max_stream_fps, heard_),
      log_("StreamDeform", "", false, &engine.metrics) {
  log_.Owner(caller_.owner);
}

// Nothing is delivered, and OnDone not called, before the RPC's method has returned.
void StreamDeformReactor::Start(const Identity& identity, const Status& admitted) {
  {
    const std::lock_guard lock(mutex_);
    self_ = shared_from_this();
    if (auto added = admitted ? engine_.streams.Add(self_, caller_) : admitted; !added) {
      end_ = std::move(added.error());
    }
    Pump();
    if (finished_) return;
  }
  watch_ = WatchCaller(*context_, identity, caller_, [weak = weak_from_this()](Fault lost) {
    if (const auto self = weak.lock()) self->End(std::move(lost));
  });
}

void StreamDeformReactor::OnReadDone(bool ok) {
  const std::lock_guard lock(mutex_);
  reading_ = false;
  (ok ? held_ : reads_done_) = true;
  heard_ = engine_.clock.SteadyNow();
  Pump();
}

void StreamDeformReactor::OnWriteDone(bool ok) {
  const std::lock_guard lock(mutex_);
  writing_ = false;
  if (!ok) cancelled_ = true;
  Pump();
}

void StreamDeformReactor::OnCancel() {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
  Pump();
}

void StreamDeformReactor::End(Fault reason) {
  const std::lock_guard lock(mutex_);
  EndLocked(std::move(reason));
  Pump();
}

void StreamDeformReactor::Sweep(runtime::Clock::Steady now) {
  const std::lock_guard lock(mutex_);
  const auto limit = engine_.limits.max_stream_idle;
  if (limit.count() <= 0 || now - heard_ < limit || ending()) return;
  const auto seconds = fmt::format("{:g}", std::chrono::duration<double>(limit).count());
  Fault idle =
      Fault(FaultKind::kStreamIdle,
            fmt::format("Nothing was said on this stream for {} s; send a ping now and then.",
                        seconds))
          .Detail("quota", "max_stream_idle")
          .Detail("limit", seconds);
  EndLocked(std::move(idle));
  // Who says nothing may not read either: a write that never ends must not keep the stream.
  if (writing_) context_->TryCancel();
  Pump();
}

void StreamDeformReactor::EndLocked(Fault reason) {
  if (!ending()) end_ = std::move(reason);
}

void StreamDeformReactor::OnDone() {
  engine_.streams.Remove(this);
  watch_ = {};
  const std::shared_ptr<StreamDeformReactor> self = std::move(self_);
  std::shared_ptr<app::Session> session;
  {
    const std::lock_guard lock(mutex_);
    session = session_;
    log_.End(end_status_,
             fmt::format(" shapes={} replaced={} errors={}", shapes_, total_replaced_, errors_));
  }
  if (session) session->RemoveEndListener(end_listener_);
}

void StreamDeformReactor::Pump() {
  if (finished_) return;
  if (ending()) {
    held_ = false;
    next_.reset();
  }
  if (cancelled_) outbox_.Clear();
  while (Take() || Read() || Begin() || Write()) {
  }
  FinishWhenOver();
}

bool StreamDeformReactor::Take() {
  if (!held_ || ending() || !TakeMessage()) return false;
  held_ = false;
  return true;
}

bool StreamDeformReactor::Read() {
  if (reading_ || held_ || reads_done_ || ending() || outbox_.pong_waits()) return false;
  reading_ = true;
  StartRead(&incoming_);
  return true;
}

bool StreamDeformReactor::Write() {
  if (writing_ || cancelled_ || !outbox_.Pop(&outgoing_)) return false;
  if (outgoing_.has_shape()) {
    ++shapes_;
    total_replaced_ += outgoing_.shape().replaced();
    engine_.metrics.Coalesced(outgoing_.shape().replaced());
  }
  if (outgoing_.has_error()) ++errors_;
  writing_ = true;
  StartWrite(&outgoing_);
  return true;
}

void StreamDeformReactor::FinishWhenOver() {
  if (writing_ || work_ != Work::kNone) return;
  if (cancelled_) {
    end_status_ = Fail(FaultKind::kCancelled, "The caller has cancelled.");
  } else if (end_) {
    end_status_ = Fail(*end_);
  } else if (!reads_done_ || held_ || next_) {
    return;
  } else if (!opened_) {
    end_status_ = Fail(FaultKind::kProtocol, "The stream ended before it was opened.");
  }
  finished_ = true;
  Finish(end_status_ ? grpc::Status::OK : ToGrpcStatus(end_status_.error()));
}

grpc::ServerBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse>* StreamDeform(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context) {
  const auto caller = CallerOf(*context, identity);
  const auto reactor =
      std::make_shared<StreamDeformReactor>(engine, context, caller.value_or(app::Caller{}));
  reactor->Start(identity, caller ? Status() : Fail(caller.error()));
  return reactor.get();
}

}  // namespace arap::rpc
