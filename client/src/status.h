// From statuses to faults: the one place that reads error details.
#pragma once

#include <optional>
#include <string_view>

#include <grpcpp/support/status.h>

#include "arap/client/error.h"
#include "google/rpc/status.pb.h"

namespace arap::client::internal {

// The fault of a status that is not OK.
Fault FaultOf(const grpc::Status& status);
// The same for a status inside a message.
Fault FaultOf(const google::rpc::Status& status);

// Whether a stream that ended so, and that we did not cancel, was lost and may go on elsewhere: its
// server is gone or going away, or a proxy says so in its own words.
bool IsLost(const grpc::Status& status);

// Whether there was no room, and later may be.
bool IsFull(const Fault& fault);

// The kind of a status that names no reason.
FaultKind KindOfCode(int code);

}  // namespace arap::client::internal
