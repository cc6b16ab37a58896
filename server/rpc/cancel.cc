#include "server/rpc/cancel.h"

#include <chrono>

#include <grpcpp/server_context.h>

namespace arap::rpc {

CancelToken CancelTokenOf(const grpc::CallbackServerContext* context) {
  return CancelToken([context]() -> Status {
    // The deadline first: when it passes, the call counts as cancelled too.
    if (std::chrono::system_clock::now() >= context->deadline()) {
      return Fail(FaultKind::kDeadlineExceeded, "The deadline has passed.");
    }
    if (context->IsCancelled()) return Fail(FaultKind::kCancelled, "The caller has cancelled.");
    return {};
  });
}

}  // namespace arap::rpc
