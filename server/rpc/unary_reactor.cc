#include "server/rpc/unary_reactor.h"

#include <utility>

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "server/rpc/cancel.h"
#include "server/rpc/rpc_log.h"
#include "server/rpc/status_map.h"
#include "server/runtime/stopwatch.h"
#include "server/runtime/worker_pool.h"
#include "server/sessions/names.h"

namespace arap::rpc {
namespace {

// Finish is called exactly once, at the end of the work, so that nothing is deleted under a worker.
class UnaryReactor final : public grpc::ServerUnaryReactor {
 public:
  UnaryReactor(grpc::CallbackServerContext* context, UnaryJob job)
      : job_(std::move(job)), log_(job_.method, job_.session_id, job_.noisy, job_.metrics) {
    call_.cancel = CancelTokenOf(context);
    call_.session = std::move(job_.session);
  }

  void Start(const Result<app::Caller>& caller) {
    if (!caller) return End(Fail(caller.error()));
    call_.caller = *caller;
    log_.Owner(caller->owner);
    if (job_.gate != nullptr) {
      auto pass = job_.gate->Enter();
      if (!pass) return End(Fail(std::move(pass.error())));
      pass_ = *std::move(pass);
    }
    if (job_.lane == nullptr) return Begin();
    Post(*job_.lane, &UnaryReactor::Begin);
  }

  void OnDone() override { delete this; }

 private:
  void Post(runtime::WorkerPool& lane, void (UnaryReactor::*step)()) {
    if (!lane.TryPost([this, step] { (this->*step)(); })) End(Fail(app::Overloaded()));
  }

  void Begin() {
    if (auto alive = call_.cancel.Check(); !alive) return End(alive);
    if (!job_.route) return Work();
    auto lane = job_.route(call_);
    if (!lane) return End(Fail(std::move(lane.error())));
    if (*lane == nullptr) return Work();
    Post(**lane, &UnaryReactor::Work);
  }

  void Work() {
    if (job_.lane != nullptr) call_.queue_micros = waiting_.Micros();
    const Status alive = call_.cancel.Check();
    End(alive ? job_.work(call_) : alive);
  }

  // The last thing that happens to this object.
  void End(const Status& status) {
    pass_.reset();
    log_.End(status);
    Finish(status ? grpc::Status::OK : ToGrpcStatus(status.error()));
  }

  UnaryJob job_;
  Call call_;
  app::Gate::Pass pass_;
  RpcLog log_;
  const runtime::Stopwatch waiting_;
};

}  // namespace

grpc::ServerUnaryReactor* RunUnary(grpc::CallbackServerContext* context,
                                   const Result<app::Caller>& caller, UnaryJob job) {
  auto* reactor = new UnaryReactor(context, std::move(job));
  reactor->Start(caller);
  return reactor;
}

}  // namespace arap::rpc
