#include "server/rpc/rpc_log.h"

#include <spdlog/spdlog.h>

#include "server/app/names.h"
#include "server/rpc/status_map.h"

namespace arap::rpc {
namespace {

// Ids come from outside: only well-formed ones enter the log.
std::string Printable(const std::string& id) {
  if (id.empty()) return "-";
  return app::IsName(id) ? id : "?";
}

}  // namespace

RpcLog::RpcLog(const char* method, const std::string& session_id, bool noisy)
    : method_(method), session_id_(Printable(session_id)), noisy_(noisy) {}

void RpcLog::Opened(const std::string& session_id) {
  session_id_ = Printable(session_id);
  spdlog::info("rpc={} session={} event=open", method_, session_id_);
}

void RpcLog::End(const Status& status, const std::string& extra) const {
  const char* code = status ? "OK" : CodeName(status.error().kind);
  const std::string reason = status ? "" : std::string(" reason=") + ReasonOf(status.error().kind);
  spdlog::log(noisy_ ? spdlog::level::debug : spdlog::level::info,
              "rpc={} session={} code={} ms={:.3f}{}{}", method_, session_id_, code,
              time_.Micros() / 1e3, reason, extra);
}

}  // namespace arap::rpc
