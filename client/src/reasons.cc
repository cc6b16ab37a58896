// The tables from wire names to kinds.
#include "arap/v1/errors.pb.h"
#include "client/src/status.h"

namespace arap::client::internal {
namespace {

std::optional<FaultKind> KindOf(v1::ErrorReason reason) {
  switch (reason) {
    case v1::ERROR_REASON_EMPTY_MESH:
      return FaultKind::kEmptyMesh;
    case v1::ERROR_REASON_ARRAY_LENGTH:
      return FaultKind::kArrayLength;
    case v1::ERROR_REASON_NON_FINITE_COORDINATE:
      return FaultKind::kNonFiniteCoordinate;
    case v1::ERROR_REASON_INDEX_OUT_OF_RANGE:
      return FaultKind::kIndexOutOfRange;
    case v1::ERROR_REASON_REPEATED_INDEX:
      return FaultKind::kRepeatedIndex;
    case v1::ERROR_REASON_DEGENERATE_TRIANGLE:
      return FaultKind::kDegenerateTriangle;
    case v1::ERROR_REASON_DUPLICATE_TRIANGLE:
      return FaultKind::kDuplicateTriangle;
    case v1::ERROR_REASON_NON_MANIFOLD_EDGE:
      return FaultKind::kNonManifoldEdge;
    case v1::ERROR_REASON_NOT_ORIENTABLE:
      return FaultKind::kNotOrientable;
    case v1::ERROR_REASON_NOT_A_DISK:
      return FaultKind::kNotADisk;
    case v1::ERROR_REASON_MESH_TOO_LARGE:
      return FaultKind::kMeshTooLarge;
    case v1::ERROR_REASON_INVALID_OPTION:
      return FaultKind::kInvalidOption;
    case v1::ERROR_REASON_HANDLE_OUTSIDE:
      return FaultKind::kHandleOutside;
    case v1::ERROR_REASON_DUPLICATE_HANDLE:
      return FaultKind::kDuplicateHandle;
    case v1::ERROR_REASON_UNKNOWN_HANDLE:
      return FaultKind::kUnknownHandle;
    case v1::ERROR_REASON_CONFLICTING_HANDLES:
      return FaultKind::kConflictingHandles;
    case v1::ERROR_REASON_NON_FINITE_TARGET:
      return FaultKind::kNonFiniteTarget;
    case v1::ERROR_REASON_TARGET_COUNT:
      return FaultKind::kTargetCount;
    case v1::ERROR_REASON_TOO_MANY_HANDLES:
      return FaultKind::kTooManyHandles;
    case v1::ERROR_REASON_INVALID_NAME:
      return FaultKind::kInvalidName;
    case v1::ERROR_REASON_NOT_FOUND:
      return FaultKind::kNotFound;
    case v1::ERROR_REASON_ALREADY_EXISTS:
      return FaultKind::kAlreadyExists;
    case v1::ERROR_REASON_PROTOCOL:
      return FaultKind::kProtocol;
    case v1::ERROR_REASON_LIMIT_EXCEEDED:
      return FaultKind::kLimitExceeded;
    case v1::ERROR_REASON_OVERLOADED:
      return FaultKind::kOverloaded;
    case v1::ERROR_REASON_DRAINING:
      return FaultKind::kDraining;
    case v1::ERROR_REASON_CANCELLED:
      return FaultKind::kCancelled;
    case v1::ERROR_REASON_DEADLINE_EXCEEDED:
      return FaultKind::kDeadlineExceeded;
    case v1::ERROR_REASON_UNIMPLEMENTED:
      return FaultKind::kUnimplemented;
    case v1::ERROR_REASON_NUMERICAL:
      return FaultKind::kNumerical;
    case v1::ERROR_REASON_INTERNAL:
      return FaultKind::kInternal;
    case v1::ERROR_REASON_NON_MANIFOLD_VERTEX:
      return FaultKind::kNonManifoldVertex;
    case v1::ERROR_REASON_UNKNOWN_EDGE:
      return FaultKind::kUnknownEdge;
    case v1::ERROR_REASON_NOT_INJECTIVE:
      return FaultKind::kNotInjective;
    case v1::ERROR_REASON_STREAM_IDLE:
      return FaultKind::kStreamIdle;
    case v1::ERROR_REASON_UNAUTHENTICATED:
      return FaultKind::kUnauthenticated;
    case v1::ERROR_REASON_PERMISSION_DENIED:
      return FaultKind::kPermissionDenied;
    case v1::ERROR_REASON_STORE_UNAVAILABLE:
      return FaultKind::kStoreUnavailable;
    case v1::ERROR_REASON_DATA_LOSS:
      return FaultKind::kDataLoss;
    case v1::ERROR_REASON_UNSPECIFIED:
    default:  // protobuf's sentinels
      break;
  }
  return std::nullopt;
}

}  // namespace

std::optional<FaultKind> KindOfReason(std::string_view reason) {
  v1::ErrorReason parsed = v1::ERROR_REASON_UNSPECIFIED;
  v1::ErrorReason_Parse("ERROR_REASON_" + std::string(reason), &parsed);
  return KindOf(parsed);
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

const char* CodeName(int code) {
  switch (code) {
    case grpc::StatusCode::OK:
      return "OK";
    case grpc::StatusCode::CANCELLED:
      return "CANCELLED";
    case grpc::StatusCode::INVALID_ARGUMENT:
      return "INVALID_ARGUMENT";
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return "DEADLINE_EXCEEDED";
    case grpc::StatusCode::NOT_FOUND:
      return "NOT_FOUND";
    case grpc::StatusCode::ALREADY_EXISTS:
      return "ALREADY_EXISTS";
    case grpc::StatusCode::PERMISSION_DENIED:
      return "PERMISSION_DENIED";
    case grpc::StatusCode::UNAUTHENTICATED:
      return "UNAUTHENTICATED";
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
      return "RESOURCE_EXHAUSTED";
    case grpc::StatusCode::FAILED_PRECONDITION:
      return "FAILED_PRECONDITION";
    case grpc::StatusCode::ABORTED:
      return "ABORTED";
    case grpc::StatusCode::OUT_OF_RANGE:
      return "OUT_OF_RANGE";
    case grpc::StatusCode::UNIMPLEMENTED:
      return "UNIMPLEMENTED";
    case grpc::StatusCode::INTERNAL:
      return "INTERNAL";
    case grpc::StatusCode::UNAVAILABLE:
      return "UNAVAILABLE";
    case grpc::StatusCode::DATA_LOSS:
      return "DATA_LOSS";
    default:
      return "UNKNOWN";
  }
}

}  // namespace arap::client::internal
