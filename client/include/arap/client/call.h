// Calls: what may be said about any of them, and what the error of one holds.
//
// Every call answers a Result whose error is a Fault (arap/base/fault.h):
//
//   kind      from the reason that the server gave. Without one the transport failed, and the kind
//             is kDraining (nobody there, or the server is going away: connect again), kOverloaded,
//             kDeadlineExceeded, kCancelled, kUnimplemented or kInternal.
//   message   the server's sentence.
//   elements  the first offending vertices, triangles or handles.
//   details   the values of the message by name, in alphabetical order; then kGrpcCodeDetail and,
//             when the server gave a time, kRetryDelayDetail. DetailOf finds one by its name.
//   field     the request field at fault in proto spelling ("handles[3].weight"), or empty.
//
// Plain values; nothing here is shared between threads.
#pragma once

#include <chrono>
#include <optional>
#include <stop_token>

#include "arap/base/fault.h"
#include "arap/base/result.h"

namespace arap::client {

using arap::DetailOf;
using arap::kGrpcCodeDetail;
using arap::kRetryDelayDetail;

struct CallOptions {
  // How long the whole call may take; the server gives up too. Without it a call waits for ever.
  std::optional<std::chrono::milliseconds> timeout = std::nullopt;
  // Asking its source to stop cancels a unary call or a track, which then answers kCancelled. From
  // any thread.
  std::stop_token stop = {};
};

}  // namespace arap::client
