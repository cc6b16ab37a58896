#include "core/base/fault.h"

namespace arap {

const char* FaultName(FaultKind kind) {
  switch (kind) {
    case FaultKind::kEmptyMesh:
      return "empty_mesh";
    case FaultKind::kArrayLength:
      return "array_length";
    case FaultKind::kNonFiniteCoordinate:
      return "non_finite_coordinate";
    case FaultKind::kIndexOutOfRange:
      return "index_out_of_range";
    case FaultKind::kRepeatedIndex:
      return "repeated_index";
    case FaultKind::kDegenerateTriangle:
      return "degenerate_triangle";
    case FaultKind::kDuplicateTriangle:
      return "duplicate_triangle";
    case FaultKind::kNonManifoldEdge:
      return "non_manifold_edge";
    case FaultKind::kNonManifoldVertex:
      return "non_manifold_vertex";
    case FaultKind::kNotOrientable:
      return "not_orientable";
    case FaultKind::kNotADisk:
      return "not_a_disk";
    case FaultKind::kUnknownEdge:
      return "unknown_edge";
    case FaultKind::kNotInjective:
      return "not_injective";
    case FaultKind::kMeshTooLarge:
      return "mesh_too_large";
    case FaultKind::kInvalidOption:
      return "invalid_option";
    case FaultKind::kHandleOutside:
      return "handle_outside";
    case FaultKind::kDuplicateHandle:
      return "duplicate_handle";
    case FaultKind::kUnknownHandle:
      return "unknown_handle";
    case FaultKind::kConflictingHandles:
      return "conflicting_handles";
    case FaultKind::kNonFiniteTarget:
      return "non_finite_target";
    case FaultKind::kTargetCount:
      return "target_count";
    case FaultKind::kTooManyHandles:
      return "too_many_handles";
    case FaultKind::kInvalidName:
      return "invalid_name";
    case FaultKind::kNotFound:
      return "not_found";
    case FaultKind::kAlreadyExists:
      return "already_exists";
    case FaultKind::kProtocol:
      return "protocol";
    case FaultKind::kLimitExceeded:
      return "limit_exceeded";
    case FaultKind::kOverloaded:
      return "overloaded";
    case FaultKind::kDraining:
      return "draining";
    case FaultKind::kCancelled:
      return "cancelled";
    case FaultKind::kDeadlineExceeded:
      return "deadline_exceeded";
    case FaultKind::kStreamIdle:
      return "stream_idle";
    case FaultKind::kUnauthenticated:
      return "unauthenticated";
    case FaultKind::kPermissionDenied:
      return "permission_denied";
    case FaultKind::kStoreUnavailable:
      return "store_unavailable";
    case FaultKind::kDataLoss:
      return "data_loss";
    case FaultKind::kUnimplemented:
      return "unimplemented";
    case FaultKind::kNumerical:
      return "numerical";
    case FaultKind::kInternal:
      return "internal";
  }
  return "internal";
}

}  // namespace arap
