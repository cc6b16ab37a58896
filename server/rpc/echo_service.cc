// EchoService: streams that compute nothing, to measure what the transport takes.
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <arap/v1/echo_service.pb.h>
#include <grpcpp/server_context.h>

#include "core/base/mutex.h"
#include "proto/convert/status.h"
#include "server/budget/faults.h"
#include "server/engine.h"
#include "server/rpc/caller_of.h"
#include "server/rpc/rpc_log.h"
#include "server/rpc/services.h"
#include "server/rpc/unary.h"

namespace arap::rpc {
namespace {

// As the reactor of a live stream, with nothing between a message and its answer: one message is
// read while the answer to the one before it is written.
class EchoReactor final : public grpc::ServerBidiReactor<v1::EchoRequest, v1::EchoResponse>,
                          public app::LongCall,
                          public std::enable_shared_from_this<EchoReactor> {
 public:
  EchoReactor(app::Engine& engine, grpc::CallbackServerContext* context, app::Caller caller)
      : engine_(engine),
        context_(context),
        caller_(std::move(caller)),
        log_("Echo", "", false, &engine.metrics) {
    log_.NamedLasting(*context);
    log_.Owner(caller_.owner);
  }

  // `admitted`: what CallerOf says. OnDone is not called before the RPC's method has returned.
  void Start(const Identity& identity, const Status& admitted) {
    self_ = shared_from_this();
    if (identity.connections != nullptr)
      counted_ = identity.connections->Begin(context_->peer(), admitted.has_value());
    const Status added = admitted ? engine_.streams.Add(self_, caller_) : admitted;
    {
      const MutexLock lock(&mutex_);
      if (!added) end_ = added.error();
      Pump();
    }
    if (!added) return;
    watch_ = WatchCaller(*context_, identity, caller_, [weak = weak_from_this()](Fault lost) {
      if (const auto self = weak.lock()) self->End(std::move(lost));
    });
  }

  void OnReadDone(bool ok) override {
    const MutexLock lock(&mutex_);
    reading_ = false;
    reads_done_ = !ok;
    if (ok) wanted_ = incoming_.answer_bytes();
    Pump();
  }

  void OnWriteDone(bool ok) override {
    const MutexLock lock(&mutex_);
    writing_ = false;
    cancelled_ = cancelled_ || !ok;
    Pump();
  }

  void OnCancel() override {
    const MutexLock lock(&mutex_);
    cancelled_ = true;
    Pump();
  }

  void End(Fault reason) override {
    const MutexLock lock(&mutex_);
    if (!end_) end_ = std::move(reason);
    Pump();
  }

  void OnDone() override {
    engine_.streams.Remove(this);
    watch_ = {};
    const std::shared_ptr<EchoReactor> self = std::move(self_);
    const MutexLock lock(&mutex_);
    log_.End(status_, "");
  }

 private:
  void Pump() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (finished_) return;
    std::optional<std::size_t> answer;
    if (!writing_ && !Ends()) answer = std::exchange(wanted_, std::nullopt);
    if (answer) {
      if (const Status fits = MakeRoom(*answer); !fits && !end_) end_ = fits.error();
    }
    if (!reading_ && !wanted_ && !reads_done_ && !Ends()) {
      reading_ = true;
      StartRead(&incoming_);
    }
    if (answer && !Ends()) {
      outgoing_.mutable_payload()->resize(*answer);
      writing_ = true;
      StartWrite(&outgoing_);
    }
    if (writing_ || (!Ends() && (wanted_ || !reads_done_))) return;
    if (cancelled_) {
      status_ = Fail(FaultKind::kCancelled, "The caller has cancelled.");
    } else if (end_) {
      status_ = Fail(*end_);
    }
    finished_ = true;
    Finish(status_ ? grpc::Status::OK : convert::ToGrpcStatus(status_.error()));
  }

  bool Ends() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return cancelled_ || end_; }

  // The answer, and what gRPC makes of it, count for as long as the stream is there.
  Status MakeRoom(std::size_t bytes) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    const std::size_t most = engine_.limits.max_message_bytes;
    if (bytes > most) return Fail(app::TooLarge("The answer", "max_message_bytes", bytes, most));
    if (bytes <= reserved_) return {};
    room_.Release();
    auto room = engine_.derived.Reserve(caller_, 2 * bytes);
    if (!room) return Fail(std::move(room.error()));
    room_ = *std::move(room);
    reserved_ = bytes;
    return {};
  }

  app::Engine& engine_;
  grpc::CallbackServerContext* const context_;
  const app::Caller caller_;
  CallerWatch watch_;                  // from Start until OnDone
  std::shared_ptr<EchoReactor> self_;  // likewise
  std::shared_ptr<const void> counted_;

  Mutex mutex_;
  // gRPC's while it reads and writes.
  v1::EchoRequest incoming_ ABSL_GUARDED_BY(mutex_);
  v1::EchoResponse outgoing_ ABSL_GUARDED_BY(mutex_);
  bool reading_ ABSL_GUARDED_BY(mutex_) = false;
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool reads_done_ ABSL_GUARDED_BY(mutex_) = false;
  bool cancelled_ ABSL_GUARDED_BY(mutex_) = false;
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  std::optional<std::size_t> wanted_ ABSL_GUARDED_BY(mutex_);  // by a message that was read
  std::optional<Fault> end_ ABSL_GUARDED_BY(mutex_);
  std::size_t reserved_ ABSL_GUARDED_BY(mutex_) = 0;
  app::DerivedCache::Reservation room_ ABSL_GUARDED_BY(mutex_);
  Status status_ ABSL_GUARDED_BY(mutex_);
  RpcLog log_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace

NamedService MakeEchoService(const Backend& backend) {
  auto service = std::make_unique<Methods>(backend, "arap.v1.EchoService");
  service->Stream<v1::EchoRequest, v1::EchoResponse>(
      "Echo", [backend](grpc::CallbackServerContext* context) {
        auto caller = CallerOf(*context, backend.identity);
        const auto reactor = std::make_shared<EchoReactor>(
            backend.engine, context, caller.value_or(app::Caller{"", {}, {}}));
        reactor->Start(backend.identity, caller ? Status() : Fail(std::move(caller.error())));
        return reactor.get();
      });
  return Named(std::move(service));
}

}  // namespace arap::rpc
