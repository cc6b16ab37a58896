// The caller's cancellation and deadline as the core's CancelToken.
#pragma once

#include "arap/base/cancel.h"

namespace grpc {
class CallbackServerContext;
}

namespace arap::rpc {

// `context` outlives every check of the token. "No deadline" reaches a server as one centuries off.
CancelToken CancelTokenOf(const grpc::CallbackServerContext* context);

}  // namespace arap::rpc
