// A call of one request whose answer comes in pieces for as long as that takes: how it is let in,
// how its request is received, how long its reader may take, and how it ends. What the pieces are is
// for the class that derives from it.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "core/base/mutex.h"
#include "proto/convert/status.h"
#include "server/budget/faults.h"
#include "server/engine.h"
#include "server/rpc/caller_of.h"
#include "server/rpc/connections.h"
#include "server/rpc/rpc_log.h"
#include "server/runtime/clock.h"
#include "server/streams/stream_policy.h"

namespace arap::rpc {

// As in the stream's reactor: state behind a mutex, every entry pumps, jobs hold a shared pointer.
// Owns itself from Start until OnDone.
template <class Request, class Response>
class LongAnswer : public grpc::ServerBidiReactor<Request, Response>,
                   public app::LongCall,
                   public std::enable_shared_from_this<LongAnswer<Request, Response>> {
 public:
  LongAnswer(const char* name, app::Engine& engine, grpc::CallbackServerContext* context,
             app::Caller caller)
      : engine_(engine),
        caller_(std::move(caller)),
        context_(context),
        log_(name, "", false, &engine.metrics) {
    log_.NamedLasting(*context);
    log_.Owner(caller_.owner);
  }

  // `admitted`: what CallerOf says. Nothing is delivered, and OnDone not called, before the RPC's
  // method has returned. The one message that comes in is read when the call is let in.
  void Start(const Identity& identity, const Status& admitted) {
    self_ = this->shared_from_this();
    Connections* const connections = identity.connections;
    if (connections != nullptr) {
      counted_ = connections->Begin(context_->peer(), admitted.has_value());
    }
    Status added = admitted ? engine_.streams.Add(self_, caller_) : admitted;
    if (added && connections != nullptr) {
      auto receiving =
          connections->Receive(context_->peer(), [weak = this->weak_from_this()](Fault late) {
            if (const auto self = weak.lock()) self->End(std::move(late));
          });
      if (!receiving) added = Fail(std::move(receiving.error()));
      const MutexLock lock(&mutex_);
      if (receiving) receiving_ = *std::move(receiving);
    }
    {
      const MutexLock lock(&mutex_);
      if (added) this->StartRead(&request_);
      reading_ = added.has_value();
      if (!added) end_ = added.error();
      Pump();
    }
    if (!added) return;
    watch_ = WatchCaller(*context_, identity, caller_, [weak = this->weak_from_this()](Fault lost) {
      if (const auto self = weak.lock()) self->End(std::move(lost));
    });
  }

  void End(Fault reason) override {
    const MutexLock lock(&mutex_);
    if (!end_ && !complete_) end_ = std::move(reason);
    Pump();
  }

  // Whoever reads nothing for as long as a stream may say nothing is cut off, and soon when the
  // call is to end.
  void Sweep(runtime::Clock::Steady now) override {
    const MutexLock lock(&mutex_);
    if (!writing_ || cancelled_) return;
    const auto idle = engine_.limits.max_stream_idle;
    if ((end_ && now - wrote_ >= app::kLastWrite) || (idle.count() > 0 && now - wrote_ >= idle)) {
      context_->TryCancel();
    }
  }

  void OnReadDone(bool ok) override {
    const std::size_t size = ok ? request_.ByteSizeLong() : 0;
    const MutexLock lock(&mutex_);
    receiving_.Received(size);
    reading_ = false;
    log_.Arrived();
    log_.Session(request_.session_id());
    const std::size_t most = engine_.limits.max_message_bytes;
    if (!ok) {
      cancelled_ = true;
    } else if (size > most && !end_) {
      end_ = app::TooLarge("The request", "max_message_bytes", size, most);
    } else if (!end_) {
      Received();
    }
    Pump();
  }

  void OnWriteDone(bool ok) override {
    const MutexLock lock(&mutex_);
    writing_ = false;
    if (!ok) cancelled_ = true;
    Pump();
  }

  void OnCancel() override {
    const MutexLock lock(&mutex_);
    cancelled_ = true;
    Pump();
  }

  void OnDone() override {
    engine_.streams.Remove(this);
    watch_ = {};
    const auto self = std::move(self_);
    const MutexLock lock(&mutex_);
    log_.End(status_, LogTail());
  }

 protected:
  // The request is there and the call goes on.
  virtual void Received() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {}
  // Starts whatever has become possible, at last FinishCall.
  virtual void Pump() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) = 0;
  // What the log's line of the call says at its end.
  virtual std::string LogTail() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return {}; }

  // True while nothing may be decided yet: a request that does not arrive is not waited for when
  // the call ends without it.
  bool Receiving() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return reading_ && !cancelled_ && !end_;
  }

  // The piece must stay as it is until the next Pump without writing_.
  void Write(const Response& piece) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    writing_ = true;
    wrote_ = engine_.clock.SteadyNow();
    this->StartWrite(&piece);
  }

  // Once, when nothing runs and nothing is being written.
  void FinishCall() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (cancelled_) {
      status_ = Fail(FaultKind::kCancelled, "The caller has cancelled.");
    } else if (end_) {
      status_ = Fail(*end_);
    }
    finished_ = true;
    this->Finish(status_ ? grpc::Status::OK : convert::ToGrpcStatus(status_.error()));
  }

  // For a job: keeps the call alive while it runs.
  template <class Derived>
  std::shared_ptr<Derived> Self() {
    return std::static_pointer_cast<Derived>(this->shared_from_this());
  }

  app::Engine& engine_;
  const app::Caller caller_;
  Request request_;  // gRPC's while reading_

  Mutex mutex_;
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool cancelled_ ABSL_GUARDED_BY(mutex_) = false;
  bool complete_ ABSL_GUARDED_BY(mutex_) = false;  // every piece is made: no fault comes any more
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  std::optional<Fault> end_ ABSL_GUARDED_BY(mutex_);

 private:
  grpc::CallbackServerContext* const context_;
  CallerWatch watch_;                 // from Start until OnDone
  std::shared_ptr<LongAnswer> self_;  // likewise
  std::shared_ptr<const void> counted_;

  Connections::Entry receiving_ ABSL_GUARDED_BY(mutex_);
  bool reading_ ABSL_GUARDED_BY(mutex_) = false;
  runtime::Clock::Steady wrote_ ABSL_GUARDED_BY(mutex_);  // when the last write began
  Status status_ ABSL_GUARDED_BY(mutex_);
  RpcLog log_ ABSL_GUARDED_BY(mutex_);
};

// A new call that CallerOf may refuse.
template <class Reactor, class... Arguments>
Reactor* BeginLongAnswer(app::Engine& engine, const Identity& identity,
                         grpc::CallbackServerContext* context, Arguments&&... arguments) {
  auto caller = CallerOf(*context, identity);
  const auto reactor = std::make_shared<Reactor>(std::forward<Arguments>(arguments)..., engine,
                                                 context, caller.value_or(app::Caller{"", {}, {}}));
  reactor->Start(identity, caller ? Status() : Fail(std::move(caller.error())));
  return reactor.get();
}

}  // namespace arap::rpc
