// Faults and statuses: the one place where either becomes the other.
//
// Every status carries google.rpc.ErrorInfo {reason: an ErrorReason without its prefix, domain:
// "arapd", metadata: the fault's details and "elements", the first offending ids}, BadRequest when
// the fault names a field, and RetryInfo with RESOURCE_EXHAUSTED and UNAVAILABLE: an hour where the
// request itself is beyond a limit.
#pragma once

#include "arap/base/fault.h"

namespace grpc {
class Status;
}
namespace google::rpc {
class Status;
}

namespace arap::convert {

// For a message inside a stream. Long texts are cut, so that the status always fits the trailers.
google::rpc::Status ToRpcStatus(const Fault& fault);
// The same for the end of an RPC.
grpc::Status ToGrpcStatus(const Fault& fault);

// The fault of a status that is not OK: of the kind that its reason names, with kGrpcCodeDetail
// and, when the server gave a time, kRetryDelayDetail behind its own details, which are in
// alphabetical order. Without a reason that this version knows the code decides (KindOfCode).
Fault FaultOf(const google::rpc::Status& status);
Fault FaultOf(const grpc::Status& status);

// The kind of a status without a reason: the transport failed, or a proxy answered.
FaultKind KindOfCode(int code);

}  // namespace arap::convert
