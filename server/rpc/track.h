// DeformTrack over gRPC: a whole track of targets in, its frames out.
//
// All frames are checked before the first is answered, except for what only the solution shows
// (CONFLICTING_HANDLES, NUMERICAL): that ends the track at its frame. One frame is computed while
// the one before it is written; a client that does not read costs one waiting frame and no thread.
#pragma once

#include <grpcpp/support/server_callback.h>

namespace arap::app {
struct Engine;
}
namespace arap::v1 {
class DeformTrackRequest;
class DeformTrackResponse;
}  // namespace arap::v1

namespace arap::rpc {

struct Identity;

// The reactor of a new call, which CallerOf may refuse; it owns itself until the call is done.
grpc::ServerWriteReactor<v1::DeformTrackResponse>* DeformTrack(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context,
    const v1::DeformTrackRequest* request);

}  // namespace arap::rpc
