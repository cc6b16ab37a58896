// Call: what a handler knows of the RPC beside its request.
#pragma once

#include "core/base/cancel.h"
#include "server/app/caller.h"

namespace arap::rpc {

struct Call {
  app::Caller caller;       // who is asking
  CancelToken cancel;       // the caller's cancellation and deadline
  double queue_micros = 0;  // how long the call waited for a worker
};

}  // namespace arap::rpc
