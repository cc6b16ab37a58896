#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <arap/v1/flattening_service.pb.h>
#include <grpcpp/server_context.h>

#include "core/base/mutex.h"
#include "core/base/try.h"
#include "proto/convert/status.h"
#include "server/budget/faults.h"
#include "server/engine.h"
#include "server/rpc/caller_of.h"
#include "server/rpc/connections.h"
#include "server/rpc/convert.h"
#include "server/rpc/long_calls.h"
#include "server/rpc/rpc_log.h"
#include "server/runtime/clock.h"
#include "server/streams/stream_policy.h"

namespace arap::rpc {
namespace {

// A step of an answer that comes in pieces.
enum class Step {
  kMore,  // the piece is to be written, the next one then
  kWait,  // the piece is to be written; the next one when Wake is called
  kLast,  // the piece is the last
};

// A call whose answer comes in pieces, each made on the control lane when the one before it was
// written. As in the track's reactor: state behind a mutex, every entry pumps, steps hold a shared
// pointer.
template <class Request, class Response>
class PiecesReactor : public grpc::ServerBidiReactor<Request, Response>,
                      public app::LongCall,
                      public std::enable_shared_from_this<PiecesReactor<Request, Response>> {
 public:
  PiecesReactor(const char* name, app::Engine& engine, grpc::CallbackServerContext* context,
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
    }
    Pump();
  }

  void End(Fault reason) override {
    const MutexLock lock(&mutex_);
    if (!end_ && !last_) end_ = std::move(reason);
    Pump();
  }

  // Whoever reads nothing for as long as a stream may say nothing is cut off, and soon when the
  // call is to end.
  void Sweep(runtime::Clock::Steady now) override {
    const MutexLock lock(&mutex_);
    if (writing_ && !cancelled_) {
      const auto idle = engine_.limits.max_stream_idle;
      if ((end_ && now - wrote_ >= app::kLastWrite) || (idle.count() > 0 && now - wrote_ >= idle)) {
        context_->TryCancel();
      }
    }
    due_ = true;
    Pump();
  }

  // The next piece is due.
  void Wake() {
    const MutexLock lock(&mutex_);
    due_ = true;
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
    log_.End(status_);
  }

 protected:
  // The next piece, on the control lane; one at a time.
  virtual Result<Step> Next(Response& piece) = 0;

  app::Engine& engine_;
  Request request_;
  const app::Caller caller_;

 private:
  // Starts whatever has become possible.
  void Pump() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (finished_ || working_ || writing_ || (reading_ && !cancelled_ && !end_)) return;
    if (cancelled_ || end_ || last_) return FinishCall();
    if (!due_) return;
    due_ = false;
    working_ = engine_.control.TryPost([self = self_] { self->Work(); }, {caller_.owner});
    if (working_) return;
    end_ = app::Overloaded();
    FinishCall();
  }

  void FinishCall() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (cancelled_) {
      status_ = Fail(FaultKind::kCancelled, "The caller has cancelled.");
    } else if (end_) {
      status_ = Fail(*end_);
    }
    finished_ = true;
    this->Finish(status_ ? grpc::Status::OK : convert::ToGrpcStatus(status_.error()));
  }

  void Work() {
    piece_.Clear();
    const auto step = OrOutOfMemory([this] { return Next(piece_); });
    const MutexLock lock(&mutex_);
    working_ = false;
    if (!step && !end_) end_ = step.error();
    if (step && !cancelled_ && !end_) {
      last_ = *step == Step::kLast;
      due_ = due_ || *step == Step::kMore;
      writing_ = true;
      wrote_ = engine_.clock.SteadyNow();
      this->StartWrite(&piece_);
    }
    Pump();
  }

  grpc::CallbackServerContext* const context_;
  CallerWatch watch_;                    // from Start until OnDone
  std::shared_ptr<PiecesReactor> self_;  // likewise
  Response piece_;                       // of the running step, then gRPC's while writing_

  std::shared_ptr<const void> counted_;  // likewise

  Mutex mutex_;
  Connections::Entry receiving_ ABSL_GUARDED_BY(mutex_);
  bool reading_ ABSL_GUARDED_BY(mutex_) = false;
  bool due_ ABSL_GUARDED_BY(mutex_) = true;
  bool working_ ABSL_GUARDED_BY(mutex_) = false;
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool last_ ABSL_GUARDED_BY(mutex_) = false;
  bool cancelled_ ABSL_GUARDED_BY(mutex_) = false;
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  runtime::Clock::Steady wrote_ ABSL_GUARDED_BY(mutex_);  // when the last write began
  std::optional<Fault> end_ ABSL_GUARDED_BY(mutex_);
  Status status_ ABSL_GUARDED_BY(mutex_);
  RpcLog log_ ABSL_GUARDED_BY(mutex_);
};

class WatchReactor final : public PiecesReactor<v1::WatchJobRequest, v1::WatchJobResponse> {
 public:
  using PiecesReactor::PiecesReactor;

 private:
  Result<Step> Next(v1::WatchJobResponse& piece) override {
    const auto wake = [weak = weak_from_this()] {
      if (const auto self = weak.lock()) self->Wake();
    };
    TRY(const auto view, engine_.flatten_jobs.Look(caller_, request_.session_id(),
                                                   request_.job_id(), wake, &listening_));
    ToWire(view, piece.mutable_job());
    return view.ended() ? Step::kLast : Step::kWait;
  }

  std::shared_ptr<app::FlattenJobs::Listening> listening_;
};

class DownloadReactor final
    : public PiecesReactor<v1::DownloadResultRequest, v1::DownloadResultResponse> {
 public:
  using PiecesReactor::PiecesReactor;

 private:
  static constexpr std::size_t kPiece = std::size_t{256} << 10u;

  Result<Step> Next(v1::DownloadResultResponse& piece) override {
    if (!fetched_) CHECK_OK(Fetch());
    piece.set_offset(at_);
    piece.set_total_bytes(result_.bytes.size());
    piece.set_data(result_.bytes.substr(at_, kPiece));
    at_ += piece.data().size();
    return at_ == result_.bytes.size() ? Step::kLast : Step::kMore;
  }

  Status Fetch() {
    TRY(result_, engine_.flatten_jobs.ResultOf(caller_, request_.session_id(), request_.job_id(),
                                               std::string().max_size()));
    if (request_.offset() > result_.bytes.size()) {
      return Fail(Fault(FaultKind::kInvalidOption, "The result ends before the offset.")
                      .Field("offset")
                      .Detail("limit", result_.bytes.size()));
    }
    at_ = request_.offset();
    fetched_ = true;
    return {};
  }

  // Of the running step.
  app::JobResult result_;
  std::size_t at_ = 0;
  bool fetched_ = false;
};

template <class Reactor>
Reactor* Begin(const char* name, app::Engine& engine, const Identity& identity,
               grpc::CallbackServerContext* context) {
  auto caller = CallerOf(*context, identity);
  const auto reactor =
      std::make_shared<Reactor>(name, engine, context, caller.value_or(app::Caller{"", {}, {}}));
  reactor->Start(identity, caller ? Status() : Fail(std::move(caller.error())));
  return reactor.get();
}

}  // namespace

grpc::ServerBidiReactor<v1::WatchJobRequest, v1::WatchJobResponse>* WatchJob(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context) {
  return Begin<WatchReactor>("WatchJob", engine, identity, context);
}

grpc::ServerBidiReactor<v1::DownloadResultRequest, v1::DownloadResultResponse>* DownloadResult(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context) {
  return Begin<DownloadReactor>("DownloadResult", engine, identity, context);
}

}  // namespace arap::rpc
