// UnaryReactor: one unary RPC whose work runs in this thread or on a lane.
#pragma once

#include <functional>
#include <string>

#include "arap/base/result.h"
#include "server/access/caller.h"
#include "server/budget/gate.h"
#include "server/rpc/call.h"

namespace grpc {
class CallbackServerContext;
class ServerUnaryReactor;
}  // namespace grpc
namespace arap::runtime {
class Metrics;
class WorkerPool;
}  // namespace arap::runtime

namespace arap::rpc {

struct UnaryJob {
  const char* method;
  std::string session_id;                 // for the log
  bool noisy = false;                     // for the log
  runtime::WorkerPool* lane;              // where it begins; null: at once in this thread
  app::Gate* gate = nullptr;              // taken until the call has ended; null: none
  std::shared_ptr<app::Session> session;  // for Call
  // Asked where the call begins: the lane on which the work is done, null for this one. May fill
  // the call. Empty: the work is done where it begins.
  std::function<Result<runtime::WorkerPool*>(Call&)> route;
  std::function<Status(const Call&)> work;  // fills the response
  runtime::Metrics* metrics = nullptr;      // counts the call
};

// Runs the job for `caller`, what CallerOf says, and finishes the call with its status. A caller
// who is refused takes no gate and no lane; a full lane answers kOverloaded, a shut gate
// kLimitExceeded, and a call that its caller has given up before it started is not begun.
grpc::ServerUnaryReactor* RunUnary(grpc::CallbackServerContext* context,
                                   const Result<app::Caller>& caller, UnaryJob job);

}  // namespace arap::rpc
