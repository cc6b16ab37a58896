// Calls: what one is called by in the logs of the server and in traces, when it is made again, what
// counts as lost, how long to wait, and the unary call that does so.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>

#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include "arap/client/call.h"
#include "client/src/leavable_call.h"
#include "proto/convert/status.h"

namespace arap::client::internal {

// So many random bytes in hexadecimal, from the system's generator.
std::string RandomHex(std::size_t bytes);

// "x-session-id", by which a load balancer finds the replica; "x-request-id", drawn anew; and W3C's
// "traceparent", the one that was given or, unless that is one, drawn anew. All attempts of one call
// have the same. Thread-safe.
class CallHeaders {
 public:
  // No session header for what is no id of a session, an empty one for example.
  explicit CallHeaders(std::string session_id, std::string traceparent = {});

  void AddTo(grpc::ClientContext& context) const;
  const std::string& request_id() const { return request_id_; }

 private:
  const std::string session_id_, request_id_, traceparent_;
};

// Whether a call that ended so, and that we did not cancel, was lost and may do better elsewhere:
// its server is gone or going away, or a proxy says so in its own words.
bool IsLost(const grpc::Status& status);

// Whether there was no room, and later may be.
bool IsFull(const Fault& fault);

// Pauses before another attempt: from 50 ms on twice as long each time, up to 2 s, and between half
// of that and all of it, so that the clients of a server that died do not come back all at once.
class Backoff {
 public:
  std::chrono::milliseconds Next();

 private:
  std::chrono::milliseconds next_{50};
};

// What repeating a call does to the server.
enum class Repeat {
  kHarmless,  // nothing that one call would not do
  kRemoval,   // what is gone already is not found: after a lost answer that counts as done
  kNever,     // it would be done twice: only a call that was surely not carried out is made again
};

// What a method is by default.
struct Method {
  Repeat repeat = Repeat::kHarmless;
  std::chrono::milliseconds limit{};
};
inline constexpr Method kLookUp{Repeat::kHarmless, kQuickLimit};
inline constexpr Method kWork{Repeat::kHarmless, kWorkLimit};
inline constexpr Method kRemove{Repeat::kRemoval, kQuickLimit};
inline constexpr Method kChange{Repeat::kNever, kWorkLimit};

// The deadline of a call that begins now; nothing for kNoLimit.
std::optional<std::chrono::system_clock::time_point> DeadlineOf(const CallOptions& call,
                                                                std::chrono::milliseconds limit);

// One of the attempts to make a call.
struct Attempt {
  const CallHeaders& headers;
  std::optional<std::chrono::system_clock::time_point> deadline;
  std::stop_token stop;

  void Prepare(grpc::ClientContext& context) const;
};

// Makes the call, and again as the method allows; `attempt` makes it once, and where the answer
// comes in pieces says in `heard` whether one came: then retry_within counts anew.
Status MakeCall(const Method& method, const CallOptions& call, const std::string& session_id,
                const std::function<grpc::Status(const Attempt&)>& attempt,
                const bool* heard = nullptr);

// One unary call: `function` is of `stub`, what a stub's async() answers, and takes a reactor.
template <class Stub, class Request, class Response>
Result<Response> Call(Stub* stub,
                      void (Stub::*function)(grpc::ClientContext*, const Request*, Response*,
                                             grpc::ClientUnaryReactor*),
                      const Request& request, const Method& method, const CallOptions& call,
                      const std::string& session_id = {}) {
  Response response;
  const auto once = [&](const Attempt& attempt) {
    const auto made = UnaryCall<Response>::Make();
    attempt.Prepare(made->context());
    (stub->*function)(&made->context(), &request, &made->response(), made.get());
    made->StartCall();
    const grpc::Status status = made->Wait(attempt.deadline, attempt.stop);
    if (status.ok()) response = std::move(made->response());
    return status;
  };
  return MakeCall(method, call, session_id, once).map([&] { return std::move(response); });
}

}  // namespace arap::client::internal
