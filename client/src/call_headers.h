// CallHeaders: what a call is called by, in the logs of the server and in traces.
#pragma once

#include <cstddef>
#include <string>

namespace grpc {
class ClientContext;
}

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

}  // namespace arap::client::internal
