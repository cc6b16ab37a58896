#include "server/rpc/rpc_log.h"

#include <atomic>
#include <cstdint>
#include <iterator>
#include <memory>
#include <random>
#include <string_view>

#include <fmt/format.h>
#include <grpcpp/server_context.h>
#include <spdlog/spdlog.h>

#include "core/base/names.h"
#include "proto/convert/status.h"
#include "server/access/caller.h"
#include "server/runtime/metrics.h"

namespace arap::rpc {
namespace {

// Ids come from outside: only well-formed ones enter the log.
std::string Printable(const std::string& id) {
  if (id.empty()) return "-";
  return IsName(id) ? id : "?";
}

// The only header of that name; empty when there is none.
std::string HeaderOf(const grpc::CallbackServerContext& context, const char* name) {
  const auto [first, last] = context.client_metadata().equal_range(name);
  if (first == last || std::next(first) != last) return {};
  return {first->second.data(), first->second.size()};
}

// The trace id of "00-TRACE-SPAN-FLAGS" in hexadecimal digits, of 32, 16 and 2; else empty.
std::string TraceOf(const std::string& parent) {
  constexpr std::string_view kForm = "00-00000000000000000000000000000000-0000000000000000-00";
  constexpr std::size_t kTraceAt = 3, kTraceDigits = 32;
  if (parent.size() != kForm.size()) return {};
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    const char c = parent[i];
    const bool digit = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
    if (kForm[i] == '-' ? c != '-' : !digit) return {};
  }
  return parent.substr(kTraceAt, kTraceDigits);
}

// Of this call, among all calls of all servers. No secret.
std::string NewId() {
  static std::atomic<std::uint64_t> next{std::random_device()() *
                                         std::uint64_t{0x9E3779B97F4A7C15}};
  std::uint64_t id = next.fetch_add(0x9E3779B97F4A7C15);
  id = (id ^ (id >> 30u)) * 0xBF58476D1CE4E5B9;
  id = (id ^ (id >> 27u)) * 0x94D049BB133111EB;
  return fmt::format("{:016x}", id ^ (id >> 31u));
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

// Nobody's name is known of a call that was refused.
void RpcLog::Owner(const std::string& owner) {
  owner_ = app::IsOwner(owner) ? owner : Printable(owner);
}

void RpcLog::Session(const std::string& session_id) { session_id_ = Printable(session_id); }

void RpcLog::Named(grpc::CallbackServerContext& context) {
  std::string id = HeaderOf(context, "x-request-id");
  if (!IsName(id)) id = NewId();
  context.AddInitialMetadata("x-request-id", id);
  names_ = " request=" + id;
  const std::string trace = TraceOf(HeaderOf(context, "traceparent"));
  if (!trace.empty()) names_ += " trace=" + trace;
}

void RpcLog::Opened(const std::string& session_id) {
  session_id_ = Printable(session_id);
  spdlog::info("rpc={} owner={} session={} event=open", method_, owner_, session_id_);
}

void RpcLog::End(const Status& status, const std::string& extra) const {
  const std::string_view code =
      status ? "OK" : CodeName(static_cast<int>(InfoOf(status.error().kind).code));
  const double seconds = time_.Micros() / 1e6;
  if (metrics_ != nullptr) {
    if (lasts_) {
      metrics_->Stream(method_, code, seconds);
    } else {
      metrics_->Rpc(method_, code, seconds);
    }
    if (!status) CountRefusal(status.error(), *metrics_);
  }
  const std::shared_ptr<spdlog::logger> access = spdlog::get(kAccessLog);
  const std::shared_ptr<spdlog::logger> log = access ? access : spdlog::default_logger();
  const auto level = noisy_ && !access ? spdlog::level::debug : spdlog::level::info;
  if (!log->should_log(level)) return;
  const std::string reason =
      status ? "" : fmt::format(" reason={}", InfoOf(status.error().kind).reason);
  log->log(level, "rpc={} owner={} session={} code={} ms={:.3f}{}{}{}", method_, owner_,
           session_id_, code, seconds * 1e3, reason, names_, extra);
}

}  // namespace arap::rpc
