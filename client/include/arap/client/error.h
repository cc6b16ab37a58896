// Errors: every call answers a Result whose error is a Fault (core/include/arap/base/fault.h).
//
//  kind      from the reason that the server gave. Without one the transport failed, and the kind
//  is
//            kDraining (nobody there, or the server is going away: connect again), kOverloaded,
//            kDeadlineExceeded, kCancelled, kUnimplemented or kInternal.
//  message   the server's sentence.
//  elements  the first offending vertices, triangles or handles.
//  details   the values of the message by name, and the two names below.
//  field     the request field at fault in proto spelling, or empty.
#pragma once

#include <string_view>

#include "arap/base/fault.h"
#include "arap/base/result.h"

namespace arap::client {

// Detail with the gRPC status code as its upper-case name ("UNAVAILABLE").
inline constexpr std::string_view kGrpcCodeDetail = "grpc_code";
// Detail with the milliseconds to wait before trying again; there when the server gave a time.
inline constexpr std::string_view kRetryDelayDetail = "retry_delay_ms";

// The detail of that name, or empty. The view lives as long as the fault.
std::string_view Detail(const Fault& fault, std::string_view name);

}  // namespace arap::client
