#include "server/rpc/status_map.h"

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include <google/rpc/error_details.pb.h>
#include <google/rpc/status.pb.h>
#include <grpcpp/support/status.h>

namespace arap::rpc {
namespace {

constexpr const char* kDomain = "arapd";
// Trailers are limited to 8 KiB in most clients; these keep the largest status below that.
constexpr std::size_t kMaxMessage = 700;
constexpr std::size_t kMaxValue = 200;
constexpr std::size_t kMaxDetails = 8;

// At most `limit` bytes, never ending within a character of UTF-8.
std::string Clip(std::string_view text, std::size_t limit) {
  if (text.size() <= limit) return std::string(text);
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u; };
  while (limit > 0 && continues(text[limit])) --limit;
  return std::string(text.substr(0, limit)) + "...";
}

std::string Join(const std::vector<std::uint32_t>& elements) {
  std::string joined;
  for (const std::uint32_t id : elements) {
    if (!joined.empty()) joined += ',';
    joined += std::to_string(id);
  }
  return joined;
}

}  // namespace

google::rpc::Status ToRpcStatus(const Fault& fault) {
  const FaultInfo& known = InfoOf(fault.kind);
  google::rpc::Status status;
  status.set_code(static_cast<int>(known.code));
  status.set_message(Clip(fault.message, kMaxMessage));

  google::rpc::ErrorInfo info;
  info.set_reason(std::string(known.reason));
  info.set_domain(kDomain);
  auto& metadata = *info.mutable_metadata();
  for (const auto& [name, value] : fault.details) {
    if (metadata.size() < kMaxDetails) metadata[Clip(name, kMaxValue)] = Clip(value, kMaxValue);
  }
  if (!fault.elements.empty()) metadata["elements"] = Join(fault.elements);
  status.add_details()->PackFrom(info);

  if (!fault.field.empty()) {
    google::rpc::BadRequest bad_request;
    auto& violation = *bad_request.add_field_violations();
    violation.set_field(Clip(fault.field, kMaxValue));
    violation.set_description(status.message());
    status.add_details()->PackFrom(bad_request);
  }
  if (known.retry.count() > 0) {
    // A field at fault is as large a second later.
    const auto delay = fault.field.empty() ? known.retry : kLimitRetry;
    google::rpc::RetryInfo retry;
    retry.mutable_retry_delay()->set_seconds(delay.count() / 1000);
    retry.mutable_retry_delay()->set_nanos(
        static_cast<std::int32_t>(delay.count() % 1000 * 1'000'000));
    status.add_details()->PackFrom(retry);
  }
  return status;
}

grpc::Status ToGrpcStatus(const Fault& fault) {
  const google::rpc::Status status = ToRpcStatus(fault);
  return {static_cast<grpc::StatusCode>(status.code()), status.message(),
          status.SerializeAsString()};
}

}  // namespace arap::rpc
