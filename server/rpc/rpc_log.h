// RpcLog: one line of key=value per RPC when it ends.
#pragma once

#include <string>

#include "core/base/result.h"
#include "server/runtime/stopwatch.h"

namespace arap::rpc {

class RpcLog {
 public:
  // A noisy method is logged at debug, the others at info.
  RpcLog(const char* method, const std::string& session_id, bool noisy);

  // rpc=Deform session=abc code=OK ms=0.91, with reason= and extra (" key=value…") appended.
  void End(const Status& status, const std::string& extra = {}) const;

  // For streams, whose session is known only later: rpc=StreamDeform session=abc event=open.
  void Opened(const std::string& session_id);

 private:
  const char* method_;
  std::string session_id_;
  bool noisy_;
  runtime::Stopwatch time_;
};

}  // namespace arap::rpc
