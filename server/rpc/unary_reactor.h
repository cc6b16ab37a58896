// UnaryReactor: one unary RPC whose work runs in this thread or on a lane.
#pragma once

#include <functional>
#include <string>

#include "core/base/result.h"
#include "server/rpc/call.h"

namespace grpc {
class CallbackServerContext;
class ServerUnaryReactor;
}  // namespace grpc
namespace arap::runtime {
class WorkerPool;
}

namespace arap::rpc {

struct UnaryJob {
  const char* method;
  std::string session_id;                   // for the log
  bool noisy = false;                       // for the log
  runtime::WorkerPool* lane;                // null: the work is trivial and runs at once
  std::function<Status(const Call&)> work;  // fills the response
};

// Runs the job and finishes the call with its status; a full lane answers kOverloaded, a call that
// its caller has given up before it started is not begun.
grpc::ServerUnaryReactor* RunUnary(grpc::CallbackServerContext* context, UnaryJob job);

}  // namespace arap::rpc
