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

using std::chrono::milliseconds;

struct Mapping {
  grpc::StatusCode code;
  const char* code_name;
  const char* reason;
  milliseconds retry;  // 0: no RetryInfo
};

constexpr milliseconds kNever{0};
constexpr milliseconds kQuotaRetry{1000};
constexpr milliseconds kQueueRetry{50};
constexpr milliseconds kDrainRetry{200};
constexpr milliseconds kStoreRetry{500};
// A request beyond a limit is refused until somebody raises the limit.
constexpr milliseconds kLimitRetry = std::chrono::hours(1);

constexpr Mapping Invalid(const char* reason) {
  return {grpc::StatusCode::INVALID_ARGUMENT, "INVALID_ARGUMENT", reason, kNever};
}
constexpr Mapping Missing(const char* reason) {
  return {grpc::StatusCode::NOT_FOUND, "NOT_FOUND", reason, kNever};
}
constexpr Mapping Unmet(const char* reason) {
  return {grpc::StatusCode::FAILED_PRECONDITION, "FAILED_PRECONDITION", reason, kNever};
}
constexpr Mapping Exhausted(const char* reason, milliseconds retry) {
  return {grpc::StatusCode::RESOURCE_EXHAUSTED, "RESOURCE_EXHAUSTED", reason, retry};
}
constexpr Mapping Internal(const char* reason) {
  return {grpc::StatusCode::INTERNAL, "INTERNAL", reason, kNever};
}

// No default: a kind without a mapping does not compile.
constexpr Mapping Map(FaultKind kind) {
  switch (kind) {
    case FaultKind::kEmptyMesh:
      return Invalid("EMPTY_MESH");
    case FaultKind::kArrayLength:
      return Invalid("ARRAY_LENGTH");
    case FaultKind::kNonFiniteCoordinate:
      return Invalid("NON_FINITE_COORDINATE");
    case FaultKind::kIndexOutOfRange:
      return Invalid("INDEX_OUT_OF_RANGE");
    case FaultKind::kRepeatedIndex:
      return Invalid("REPEATED_INDEX");
    case FaultKind::kDegenerateTriangle:
      return Invalid("DEGENERATE_TRIANGLE");
    case FaultKind::kDuplicateTriangle:
      return Invalid("DUPLICATE_TRIANGLE");
    case FaultKind::kNonManifoldEdge:
      return Invalid("NON_MANIFOLD_EDGE");
    case FaultKind::kNonManifoldVertex:
      return Invalid("NON_MANIFOLD_VERTEX");
    case FaultKind::kNotOrientable:
      return Invalid("NOT_ORIENTABLE");
    case FaultKind::kNotADisk:
      return Invalid("NOT_A_DISK");
    case FaultKind::kUnknownEdge:
      return Invalid("UNKNOWN_EDGE");
    case FaultKind::kNotInjective:
      return Unmet("NOT_INJECTIVE");
    case FaultKind::kMeshTooLarge:
      return Exhausted("MESH_TOO_LARGE", kLimitRetry);
    case FaultKind::kInvalidOption:
      return Invalid("INVALID_OPTION");
    case FaultKind::kHandleOutside:
      return Invalid("HANDLE_OUTSIDE");
    case FaultKind::kDuplicateHandle:
      return Invalid("DUPLICATE_HANDLE");
    case FaultKind::kUnknownHandle:
      return Missing("UNKNOWN_HANDLE");
    case FaultKind::kConflictingHandles:
      return Invalid("CONFLICTING_HANDLES");
    case FaultKind::kNonFiniteTarget:
      return Invalid("NON_FINITE_TARGET");
    case FaultKind::kTargetCount:
      return Invalid("TARGET_COUNT");
    case FaultKind::kTooManyHandles:
      return Exhausted("TOO_MANY_HANDLES", kLimitRetry);
    case FaultKind::kInvalidName:
      return Invalid("INVALID_NAME");
    case FaultKind::kNotFound:
      return Missing("NOT_FOUND");
    case FaultKind::kAlreadyExists:
      return {grpc::StatusCode::ALREADY_EXISTS, "ALREADY_EXISTS", "ALREADY_EXISTS", kNever};
    case FaultKind::kProtocol:
      return Unmet("PROTOCOL");
    case FaultKind::kLimitExceeded:
      return Exhausted("LIMIT_EXCEEDED", kQuotaRetry);
    case FaultKind::kOverloaded:
      return Exhausted("OVERLOADED", kQueueRetry);
    case FaultKind::kDraining:
      return {grpc::StatusCode::UNAVAILABLE, "UNAVAILABLE", "DRAINING", kDrainRetry};
    case FaultKind::kCancelled:
      return {grpc::StatusCode::CANCELLED, "CANCELLED", "CANCELLED", kNever};
    case FaultKind::kDeadlineExceeded:
      return {grpc::StatusCode::DEADLINE_EXCEEDED, "DEADLINE_EXCEEDED", "DEADLINE_EXCEEDED",
              kNever};
    case FaultKind::kStreamIdle:
      return {grpc::StatusCode::ABORTED, "ABORTED", "STREAM_IDLE", kNever};
    case FaultKind::kUnauthenticated:
      return {grpc::StatusCode::UNAUTHENTICATED, "UNAUTHENTICATED", "UNAUTHENTICATED", kNever};
    case FaultKind::kPermissionDenied:
      return {grpc::StatusCode::PERMISSION_DENIED, "PERMISSION_DENIED", "PERMISSION_DENIED",
              kNever};
    case FaultKind::kStoreUnavailable:
      return {grpc::StatusCode::UNAVAILABLE, "UNAVAILABLE", "STORE_UNAVAILABLE", kStoreRetry};
    case FaultKind::kDataLoss:
      return {grpc::StatusCode::DATA_LOSS, "DATA_LOSS", "DATA_LOSS", kNever};
    case FaultKind::kUnimplemented:
      return {grpc::StatusCode::UNIMPLEMENTED, "UNIMPLEMENTED", "UNIMPLEMENTED", kNever};
    case FaultKind::kNumerical:
      return Internal("NUMERICAL");
    case FaultKind::kInternal:
      return Internal("INTERNAL");
  }
  return Internal("INTERNAL");
}

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

const char* ReasonOf(FaultKind kind) { return Map(kind).reason; }

const char* CodeName(FaultKind kind) { return Map(kind).code_name; }

google::rpc::Status ToRpcStatus(const Fault& fault) {
  const Mapping mapping = Map(fault.kind);
  google::rpc::Status status;
  status.set_code(static_cast<int>(mapping.code));
  status.set_message(Clip(fault.message, kMaxMessage));

  google::rpc::ErrorInfo info;
  info.set_reason(mapping.reason);
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
  if (mapping.retry != kNever) {
    // A field at fault is as large a second later.
    const milliseconds delay = fault.field.empty() ? mapping.retry : kLimitRetry;
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
