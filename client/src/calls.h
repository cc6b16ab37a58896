// Calls: what one is called by in the logs of the server and in traces, when it is made again, what
// counts as lost, how long to wait, the unary call that does so, and what ends a call whose next
// message does not come.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include "arap/client/call.h"
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

// Makes the call, and again as the method allows; `attempt` makes it once, and where the answer
// comes in pieces says in `heard` whether one came: then retry_within counts anew.
Status MakeCall(const Method& method, const CallOptions& call, const std::string& session_id,
                const std::function<grpc::Status(grpc::ClientContext&)>& attempt,
                const bool* heard = nullptr);

// One unary call: `function` is the stub's.
template <class Stub, class Request, class Response>
Result<Response> Call(Stub& stub,
                      grpc::Status (Stub::*function)(grpc::ClientContext*, const Request&,
                                                     Response*),
                      const Request& request, const Method& method, const CallOptions& call,
                      const std::string& session_id = {}) {
  Response response;
  return MakeCall(method, call, session_id,
                  [&](grpc::ClientContext& context) {
                    response.Clear();
                    return (stub.*function)(&context, request, &response);
                  })
      .map([&] { return std::move(response); });
}

// Ends a call whose next message does not come. Has a thread of its own for as long as it lives.
// `context` outlives it, and its call begins after it.
class Impatience {
 public:
  // Cancels the call when nothing has come for `limit` while it was waited for.
  Impatience(grpc::ClientContext& context, std::chrono::milliseconds limit);

  // What `read` answers, which waits for a message or the end.
  template <class Read>
  bool Wait(const Read& read) {
    SetWaiting(true);
    const bool got = read();
    SetWaiting(false);
    return got;
  }
  // Whether it has cancelled the call. From any thread.
  bool is_lost() const;

 private:
  void SetWaiting(bool waiting);

  const std::chrono::milliseconds limit_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::uint64_t changes_ = 0;
  bool waiting_ = false;
  bool lost_ = false;
  std::jthread watch_;  // last: it uses all of the above
};

}  // namespace arap::client::internal
