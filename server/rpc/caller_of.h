// What gRPC knows of a call: who is behind it (a bearer token, else a client certificate, else
// nobody), and whether the answer is still wanted.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "server/access/caller.h"
#include "server/access/tokens.h"
#include "server/rpc/connections.h"

namespace grpc {
class CallbackServerContext;
}

namespace arap::rpc {

// What a server asks of its callers. The default takes whoever comes.
struct Identity {
  std::shared_ptr<app::Tokens> tokens;  // null: tokens are refused
  bool demanded = false;                // those without identity are refused
  OwnerLimits limits;                   // of owners that come without a token
  Connections* connections = nullptr;   // hears of callers that are let in; null: nobody does
};

// The header "authorization: Bearer TOKEN" decides when it is there: a token that does not hold is
// never excused by a certificate. Without it the common name of a verified client certificate is
// the owner, with the role of a user. Without either the owner is kNobody. Faults:
// kUnauthenticated, which says what is missing and nothing of what was sent. With the token of a
// gateway the header "x-arapd-owner: NAME" makes the caller the owner "GATEWAY/NAME"; without such a
// token it is refused. The header x-session-id plays no part.
Result<app::Caller> CallerOf(const grpc::CallbackServerContext& context, const Identity& identity);

// For calls that last: `lost` runs with kUnauthenticated when the token that the call came with does
// not hold any more (see Tokens::Watch), and with kDraining when its connection has reached its age
// (see Connections::WatchAge).
struct CallerWatch {
  app::TokenWatch token;
  Connections::Entry age;
};
CallerWatch WatchCaller(const grpc::CallbackServerContext& context, const Identity& identity,
                        const app::Caller& caller, const std::function<void(Fault)>& lost);

// The caller's cancellation and deadline. `context` outlives every check of the token. A check is
// also where a job gives way to frames (runtime::GiveWay).
CancelToken CancelTokenOf(const grpc::CallbackServerContext* context);

}  // namespace arap::rpc
