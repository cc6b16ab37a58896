// The unary call: who asks → where it runs → the handler → the answer. A service names its methods
// with what they cost and hands each request to Run.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "core/base/try.h"
#include "server/access/caller.h"
#include "server/budget/gate.h"
#include "server/engine.h"
#include "server/rpc/caller_of.h"
#include "server/rpc/costs.h"

namespace arap::rpc {

// What a handler knows of the RPC beside its request.
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

// Checks and converts, uses the engine, converts back. It blocks on nothing but its own work. On a
// fault the response is unused.
template <class Request, class Response>
using Handler = Status (*)(app::Engine&, const Request&, const Call&, Response*);

// What a handler does decides where it runs. What is expected to take longer than kLongFrameSeconds
// is a job (costs.h).
enum class Cost {
  kTrivial,  // says what is known: at once
  kStore,    // may wait for the store: control
  kLookUp,   // the same, and when what it looks up was evicted: jobs
  kFrame,    // computes a frame: interactive; when what it needs was evicted: jobs
  kHeavy,    // factors or back-substitutions: jobs
};

struct Method {
  const char* name;
  Cost cost;
  bool noisy = false;         // logged at debug only
  app::Gate* gate = nullptr;  // taken until the call has ended; null: none
  bool open_to_all = false;   // needs no identity
};

// What every service works with. Both outlive it.
struct Backend {
  app::Engine& engine;
  const Identity& identity;
};

// A request without its type.
struct UnaryJob {
  std::string session_id;                   // for the log
  std::function<Status(const Call&)> work;  // fills the response
  std::size_t bytes = 0;                    // of the request, in memory
  // Empty for what computes nothing.
  std::function<Expected(const app::Session*)> expect;
};

// kLimitExceeded for a request beyond max_message_bytes.
Status CheckSize(const Limits& limits, std::size_t request_bytes);

// Finishes the call with the status of its work. A caller who is refused takes no gate and no lane
// and looks nothing up; a full lane answers kOverloaded and a shut gate kLimitExceeded, with what
// waits before it and for how long; a request that there is no memory for is kLimitExceeded, and a
// call that its caller has given up before it started is not begun.
grpc::ServerUnaryReactor* RunUnary(const Backend& backend, const Method& method,
                                   grpc::CallbackServerContext* context, UnaryJob job);

// The request and the response are gRPC's until the call has ended.
template <class Request, class Response>
grpc::ServerUnaryReactor* Run(const Backend& backend, const Method& method,
                              grpc::CallbackServerContext* context, const Request* request,
                              Response* response, Handler<Request, Response> handler) {
  app::Engine& engine = backend.engine;
  UnaryJob job;
  job.work = [&engine, request, response, handler](const Call& call) -> Status {
    CHECK_OK(CheckSize(engine.limits, request->ByteSizeLong()));
    return handler(engine, *request, call, response);
  };
  if constexpr (requires { request->session_id(); }) job.session_id = request->session_id();
  job.bytes = request->SpaceUsedLong();
  if constexpr (requires { ExpectedOf(engine, nullptr, *request); }) {
    job.expect = [&engine, request](const app::Session* session) {
      return ExpectedOf(engine, session, *request);
    };
  }
  return RunUnary(backend, method, context, std::move(job));
}

}  // namespace arap::rpc
