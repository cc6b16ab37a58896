// status_map: the one place where faults become statuses of the wire.
//
// Every status carries google.rpc.ErrorInfo {reason: an ErrorReason without its prefix, domain:
// "arapd", metadata: the fault's details and "elements", the first offending ids}, BadRequest when
// the fault names a field, and RetryInfo with RESOURCE_EXHAUSTED and UNAVAILABLE: an hour where the
// request itself is beyond a limit.
#pragma once

#include <string>

#include "arap/base/fault.h"

namespace grpc {
class Status;
}
namespace google::rpc {
class Status;
}

namespace arap::rpc {

// For the end of an RPC. Long texts are cut, so that the status always fits the trailers.
grpc::Status ToGrpcStatus(const Fault& fault);
// The same for a message inside a stream.
google::rpc::Status ToRpcStatus(const Fault& fault);

}  // namespace arap::rpc
