#include "server/rpc/rpc_log.h"

#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/base/names.h"
#include "proto/convert/status.h"
#include "server/runtime/metrics.h"

namespace arap::rpc {
namespace {

// Ids come from outside: only well-formed ones enter the log.
std::string Printable(const std::string& id) {
  if (id.empty()) return "-";
  return IsName(id) ? id : "?";
}

}  // namespace

void CountRefusal(const Fault& fault, runtime::Metrics& metrics) {
  if (fault.kind == FaultKind::kOverloaded) metrics.Rejected("queue");
  for (const auto& [name, value] : fault.details) {
    if (name == "quota") metrics.Rejected(value);
  }
}

RpcLog::RpcLog(const char* method, const std::string& session_id, bool noisy,
               runtime::Metrics* metrics)
    : method_(method), session_id_(Printable(session_id)), noisy_(noisy), metrics_(metrics) {}

void RpcLog::Owner(const std::string& owner) { owner_ = Printable(owner); }

void RpcLog::Opened(const std::string& session_id) {
  session_id_ = Printable(session_id);
  spdlog::info("rpc={} owner={} session={} event=open", method_, owner_, session_id_);
}

void RpcLog::End(const Status& status, const std::string& extra) const {
  const std::string_view code =
      status ? "OK" : CodeName(static_cast<int>(InfoOf(status.error().kind).code));
  const double seconds = time_.Micros() / 1e6;
  if (metrics_ != nullptr) {
    metrics_->Rpc(method_, code, seconds);
    if (!status) CountRefusal(status.error(), *metrics_);
  }
  const std::shared_ptr<spdlog::logger> access = spdlog::get(kAccessLog);
  const std::shared_ptr<spdlog::logger> log = access ? access : spdlog::default_logger();
  const auto level = noisy_ && !access ? spdlog::level::debug : spdlog::level::info;
  if (!log->should_log(level)) return;
  const std::string reason =
      status ? "" : fmt::format(" reason={}", InfoOf(status.error().kind).reason);
  log->log(level, "rpc={} owner={} session={} code={} ms={:.3f}{}{}", method_, owner_, session_id_,
           code, seconds * 1e3, reason, extra);
}

}  // namespace arap::rpc
