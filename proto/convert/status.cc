#include "proto/convert/status.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <google/rpc/error_details.pb.h>
#include <google/rpc/status.pb.h>
#include <grpcpp/support/status.h>

#include "proto/convert/plain.h"

namespace arap::convert {
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

// Whatever separates them: the ids are the runs of digits.
void ReadElements(std::string_view text, Fault& fault) {
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    std::uint32_t id = 0;
    const auto [next, error] = std::from_chars(at, end, id);
    if (error == std::errc()) fault.Element(id);
    at = next == at ? at + 1 : next;
  }
}

void Read(const google::rpc::ErrorInfo& info, Fault& fault) {
  if (const std::optional<FaultKind> kind = KindOfReason(info.reason())) {
    fault.kind = *kind;
  } else {
    fault.Detail("reason", info.reason());  // of a newer server; the code has chosen the kind
  }
  for (const auto& [name, value] : info.metadata()) {
    if (name == "elements") {
      ReadElements(value, fault);
    } else {
      fault.Detail(name, value);
    }
  }
  // Protobuf maps have no order of their own.
  std::sort(fault.details.begin(), fault.details.end());
}

std::string Milliseconds(const google::protobuf::Duration& duration) {
  using std::chrono::milliseconds;
  return std::to_string(std::chrono::duration_cast<milliseconds>(FromWire(duration)).count());
}

}  // namespace

namespace {

// When to try again; 0 for never.
std::chrono::milliseconds RetryOf(const Fault& fault, const FaultInfo& known) {
  if (known.retry.count() <= 0) return known.retry;
  // Who made the fault may know better.
  const std::string_view told = DetailOf(fault, kRetryDelayDetail);
  std::chrono::milliseconds::rep delay = 0;
  if (std::from_chars(told.data(), told.data() + told.size(), delay).ec == std::errc()) {
    return std::chrono::milliseconds(delay);
  }
  // When the fault names a field the request itself is too large: trying again soon cannot help.
  return fault.field.empty() ? known.retry : kLimitRetry;
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
    if (name == kRetryDelayDetail) continue;
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
  if (const auto delay = RetryOf(fault, known); delay.count() > 0) {
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

Fault FaultOf(const google::rpc::Status& status) {
  Fault fault;
  fault.kind = KindOfCode(status.code());
  fault.message = status.message();
  std::string retry_delay;
  for (const google::protobuf::Any& detail : status.details()) {
    google::rpc::ErrorInfo info;
    google::rpc::BadRequest bad_request;
    google::rpc::RetryInfo retry;
    if (detail.UnpackTo(&info)) {
      Read(info, fault);
    } else if (detail.UnpackTo(&bad_request) && bad_request.field_violations_size() > 0) {
      fault.Field(bad_request.field_violations(0).field());
    } else if (detail.UnpackTo(&retry)) {
      retry_delay = Milliseconds(retry.retry_delay());
    }
  }
  fault.Detail(std::string(kGrpcCodeDetail), std::string(CodeName(status.code())));
  if (!retry_delay.empty()) fault.Detail(std::string(kRetryDelayDetail), retry_delay);
  return fault;
}

Fault FaultOf(const grpc::Status& status) {
  google::rpc::Status message;
  // Details that do not parse are a broken proxy's; the code and the message still count.
  if (!message.ParseFromString(status.error_details())) message.clear_details();
  message.set_code(status.error_code());
  message.set_message(status.error_message());
  return FaultOf(message);
}

FaultKind KindOfCode(int code) {
  switch (code) {
    case grpc::StatusCode::UNAVAILABLE:
      return FaultKind::kDraining;
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
      return FaultKind::kOverloaded;
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return FaultKind::kDeadlineExceeded;
    case grpc::StatusCode::CANCELLED:
      return FaultKind::kCancelled;
    case grpc::StatusCode::UNIMPLEMENTED:
      return FaultKind::kUnimplemented;
    default:
      return FaultKind::kInternal;
  }
}

}  // namespace arap::convert
