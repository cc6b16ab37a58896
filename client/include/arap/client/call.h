// Calls: what may be said about any of them, how long they take at most, when they are made again,
// and what the error of one holds.
//
// Every call answers a Result whose error is a Fault (arap/base/fault.h):
//
//   kind      from the reason that the server gave. Without one the transport failed, and the kind
//             is kDraining (nobody there, or the server is going away: connect again), kOverloaded,
//             kDeadlineExceeded, kCancelled, kUnimplemented or kInternal.
//   message   the server's sentence.
//   elements  the first offending vertices, triangles or handles.
//   details   the values of the message by name, in alphabetical order; then kGrpcCodeDetail,
//             kRetryDelayDetail when the server gave a time, and kRequestIdDetail for a call that is
//             not a stream. DetailOf finds one by its name.
//   field     the request field at fault in proto spelling ("handles[3].weight"), or empty.
//
// Every answer is checked against what was asked before it is handed out: lengths, indices, ids,
// sequences, finite coordinates. One that does not fit is kInternal, and its sentence says what the
// server answered. Text of a server (messages, warnings, labels) is as it sent it, and may hold
// anything that UTF-8 can say: make it harmless before a terminal sees it.
//
// A call that was lost (the server is gone, going away, or was never reached) or that the server
// refused before it began (OVERLOADED, DRAINING) is made again, for as long as
// CallOptions::retry_within says and the deadline allows, after growing pauses of 50 ms to 2 s or
// as long as the server asks. That is done
//
//   in any case  by what only asks, and by what gives the same when it is done twice: the methods
//                Get…, List…, Flatten, Deform, CreateSession, RegisterMesh, CompileHandles,
//                SubmitFlatten, CancelJob; WatchJob and GetResult go on where they were lost
//   and by       Delete…, where nothing to delete after a lost answer means that it was done
//   only when    the server says that it has not begun: EditHandles
//   never        by DeformTrack; streams resume when they are asked to (deform_stream.h)
//
// Plain values; nothing here is shared between threads.
#pragma once

#include <chrono>
#include <optional>
#include <stop_token>
#include <string>

#include "arap/base/fault.h"
#include "arap/base/result.h"

namespace arap::client {

using arap::DetailOf;
using arap::kGrpcCodeDetail;
using arap::kRetryDelayDetail;

// What the server's logs call the call, sent as the header "x-request-id".
inline constexpr std::string_view kRequestIdDetail = "request_id";

// How long a call may take that is not told: one that only looks something up or removes it, and
// one that computes.
inline constexpr std::chrono::milliseconds kQuickLimit = std::chrono::seconds(30);
inline constexpr std::chrono::milliseconds kWorkLimit = std::chrono::minutes(10);
// A timeout for calls that may take for ever.
inline constexpr std::chrono::milliseconds kNoLimit = std::chrono::milliseconds::max();

struct CallOptions {
  // How long the whole call may take, with all its attempts; the server gives up too. Without it
  // kQuickLimit or kWorkLimit, as the method says. A track without it may take as long as its
  // frames come, a job may be watched for as long as it is told of, and a stream may last for ever;
  // see there.
  std::optional<std::chrono::milliseconds> timeout = std::nullopt;
  // Asking its source to stop cancels any call but a stream, which then answers kCancelled. From
  // any thread.
  std::stop_token stop = {};
  // For how long after its first failure a call is made again, or after the last piece of an answer
  // that comes in pieces; 0: not at all.
  std::chrono::milliseconds retry_within = std::chrono::seconds(5);
  // W3C's "traceparent" of what the call is part of. Empty, or none: a trace of its own.
  std::string traceparent = {};
};

}  // namespace arap::client
