#include "client/src/status.h"

#include <algorithm>
#include <charconv>
#include <string>

#include "google/rpc/error_details.pb.h"

namespace arap::client {

std::string_view Detail(const Fault& fault, std::string_view name) {
  for (const auto& [key, value] : fault.details) {
    if (key == name) return value;
  }
  return {};
}

namespace internal {
namespace {

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
  return std::to_string(duration.seconds() * 1000 + duration.nanos() / 1'000'000);
}

}  // namespace

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

bool IsLost(const grpc::Status& status) {
  const auto says = [&](std::string_view words) {
    return status.error_message().find(words) != std::string::npos;
  };
  switch (status.error_code()) {
    case grpc::StatusCode::UNAVAILABLE:
    case grpc::StatusCode::CANCELLED:  // a server that stops, haproxy
      return true;
    case grpc::StatusCode::UNKNOWN:
      return says("No status received");
    case grpc::StatusCode::INTERNAL:
      return says("RST_STREAM");
    default:
      return false;
  }
}

bool IsFull(const Fault& fault) { return Detail(fault, kGrpcCodeDetail) == "RESOURCE_EXHAUSTED"; }

}  // namespace internal
}  // namespace arap::client
