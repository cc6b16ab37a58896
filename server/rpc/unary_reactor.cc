#include "server/rpc/unary_reactor.h"

#include <utility>

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "server/app/names.h"
#include "server/rpc/cancel.h"
#include "server/rpc/rpc_log.h"
#include "server/rpc/status_map.h"
#include "server/runtime/stopwatch.h"
#include "server/runtime/worker_pool.h"

namespace arap::rpc {
namespace {

// Finish is called exactly once, at the end of the work, so that nothing is deleted under a worker.
class UnaryReactor final : public grpc::ServerUnaryReactor {
 public:
  UnaryReactor(grpc::CallbackServerContext* context, UnaryJob job)
      : context_(context), job_(std::move(job)), log_(job_.method, job_.session_id, job_.noisy) {}

  void Start() {
    if (job_.lane == nullptr) return Work();
    if (!job_.lane->TryPost([this] { Work(); })) End(Fail(app::Overloaded()));
  }

  void OnDone() override { delete this; }

 private:
  void Work() {
    const Call call{{}, CancelTokenOf(context_), job_.lane == nullptr ? 0 : waiting_.Micros()};
    const Status alive = call.cancel.Check();
    End(alive ? job_.work(call) : alive);
  }

  // The last thing that happens to this object.
  void End(const Status& status) {
    log_.End(status);
    Finish(status ? grpc::Status::OK : ToGrpcStatus(status.error()));
  }

  grpc::CallbackServerContext* const context_;
  const UnaryJob job_;
  const RpcLog log_;
  const runtime::Stopwatch waiting_;
};

}  // namespace

grpc::ServerUnaryReactor* RunUnary(grpc::CallbackServerContext* context, UnaryJob job) {
  auto* reactor = new UnaryReactor(context, std::move(job));
  reactor->Start();
  return reactor;
}

}  // namespace arap::rpc
