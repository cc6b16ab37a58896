// StreamDeform over gRPC: moves the bytes of a live stream. The rules are in
// deformation_service.proto for clients and in server/streams/stream_policy.h for how they are
// kept.
#pragma once

#include <grpcpp/support/server_callback.h>

namespace arap::app {
struct Engine;
}
namespace arap::v1 {
class StreamDeformRequest;
class StreamDeformResponse;
}  // namespace arap::v1

namespace arap::rpc {

struct Identity;

// The reactor of a new call, which CallerOf may refuse; it owns itself until the call is done.
grpc::ServerBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse>* StreamDeform(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context);

}  // namespace arap::rpc
