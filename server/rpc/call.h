// Call: what a handler knows of the RPC beside its request.
#pragma once

#include <memory>
#include <string>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "server/access/caller.h"

namespace arap::app {
struct Engine;
class Session;
}  // namespace arap::app

namespace arap::rpc {

struct Call {
  app::Caller caller;       // who is asking
  CancelToken cancel;       // the caller's cancellation and deadline
  double queue_micros = 0;  // how long the call waited for a worker
  // The session of the request, if it was looked up on the way to the lane.
  std::shared_ptr<app::Session> session;
};

// The session of that id; the one that was looked up already, or the caller's. Faults: those of
// SessionRegistry::Use.
Result<std::shared_ptr<app::Session>> SessionOf(app::Engine& engine, const Call& call,
                                                const std::string& session_id);

}  // namespace arap::rpc
