// RpcLog: one line of key=value per RPC when it ends, and its count and time in the metrics.
//
// With a logger of the name kAccessLog, every RPC has a line there. Without, the lines go into the
// default log, those of noisy methods at debug. Only names enter: no token, no target, no mesh.
#pragma once

#include <string>

#include "arap/base/result.h"
#include "server/runtime/clock.h"

namespace grpc {
class CallbackServerContext;
}
namespace arap::runtime {
class Metrics;
}

namespace arap::rpc {

inline constexpr const char* kAccessLog = "access";

// Counts the quota that refused something, if `fault` is such a refusal.
void CountRefusal(const Fault& fault, runtime::Metrics& metrics);

class RpcLog {
 public:
  // `metrics` may be null; it outlives this.
  RpcLog(const char* method, const std::string& session_id, bool noisy,
         runtime::Metrics* metrics = nullptr);

  // What the call says of itself, before it is answered: the trace of W3C's traceparent, and
  // x-request-id, or an id of ours, which goes back to the caller under that name.
  void Named(grpc::CallbackServerContext& context);
  // The same for a stream or a track: how long these live is counted apart from how long calls
  // take.
  void NamedLasting(grpc::CallbackServerContext& context) {
    lasts_ = true;
    Named(context);
  }
  // Who is calling, once that is known.
  void Owner(const std::string& owner);
  // The request is here: time counts from now.
  void Arrived() { time_ = {}; }
  void Session(const std::string& session_id);

  // rpc=Deform owner=alice session=abc code=OK ms=0.91, with reason=, request=, trace= and extra
  // (" key=value…") appended. Counts the RPC, and the quota if one refused it.
  void End(const Status& status, const std::string& extra = {}) const;

  // For streams, whose session is known only later: rpc=StreamDeform session=abc event=open.
  void Opened(const std::string& session_id);

 private:
  const char* method_;
  std::string session_id_;
  std::string owner_ = "-";
  std::string names_;  // " request=… trace=…"
  bool noisy_;
  bool lasts_ = false;
  runtime::Metrics* metrics_;
  runtime::WallTimer time_;
};

}  // namespace arap::rpc
