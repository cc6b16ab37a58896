#include <cstddef>
#include <memory>
#include <string>

#include <arap/v1/flattening_service.pb.h>

#include "core/base/mutex.h"
#include "core/base/try.h"
#include "server/budget/faults.h"
#include "server/engine.h"
#include "server/rpc/convert.h"
#include "server/rpc/long_answer.h"
#include "server/rpc/long_calls.h"
#include "server/runtime/clock.h"

namespace arap::rpc {
namespace {

// A step of an answer that comes in pieces.
enum class Step {
  kMore,  // the piece is to be written, the next one then
  kWait,  // the piece is to be written; the next one when Wake is called
  kLast,  // the piece is the last
};

// A piece at a time, each made on the control lane when the one before it was written.
template <class Request, class Response>
class PiecesReactor : public LongAnswer<Request, Response> {
 public:
  using LongAnswer<Request, Response>::LongAnswer;

  // A piece is due at every sweep.
  void Sweep(runtime::Clock::Steady now) override {
    LongAnswer<Request, Response>::Sweep(now);
    Wake();
  }

  // The next piece is due.
  void Wake() {
    const MutexLock lock(&this->mutex_);
    due_ = true;
    Pump();
  }

 protected:
  // The next piece, on the control lane; one at a time.
  virtual Result<Step> Next(Response& piece) = 0;

 private:
  void Pump() ABSL_EXCLUSIVE_LOCKS_REQUIRED(this->mutex_) override {
    if (this->finished_ || working_ || this->writing_ || this->Receiving()) return;
    if (this->cancelled_ || this->end_ || this->complete_) return this->FinishCall();
    if (!due_) return;
    due_ = false;
    working_ = this->engine_.control.TryPost(
        [self = this->template Self<PiecesReactor>()] { self->Work(); }, {this->caller_.owner});
    if (working_) return;
    this->end_ = app::Overloaded();
    this->FinishCall();
  }

  void Work() {
    piece_.Clear();
    const auto step = OrOutOfMemory([this] { return Next(piece_); });
    const MutexLock lock(&this->mutex_);
    working_ = false;
    if (!step && !this->end_) this->end_ = step.error();
    if (step && !this->cancelled_ && !this->end_) {
      this->complete_ = *step == Step::kLast;
      due_ = due_ || *step == Step::kMore;
      this->Write(piece_);
    }
    Pump();
  }

  Response piece_;  // of the running step, then gRPC's while writing_
  bool due_ ABSL_GUARDED_BY(this->mutex_) = true;
  bool working_ ABSL_GUARDED_BY(this->mutex_) = false;
};

class WatchReactor final : public PiecesReactor<v1::WatchJobRequest, v1::WatchJobResponse> {
 public:
  using PiecesReactor::PiecesReactor;

 private:
  Result<Step> Next(v1::WatchJobResponse& piece) override {
    const auto wake = [weak = weak_from_this()] {
      if (const auto self = weak.lock()) std::static_pointer_cast<WatchReactor>(self)->Wake();
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

}  // namespace

grpc::ServerBidiReactor<v1::WatchJobRequest, v1::WatchJobResponse>* WatchJob(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context) {
  return BeginLongAnswer<WatchReactor>(engine, identity, context, "WatchJob");
}

grpc::ServerBidiReactor<v1::DownloadResultRequest, v1::DownloadResultResponse>* DownloadResult(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context) {
  return BeginLongAnswer<DownloadReactor>(engine, identity, context, "DownloadResult");
}

}  // namespace arap::rpc
