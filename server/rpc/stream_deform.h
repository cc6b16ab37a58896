// StreamDeform: one live stream of handle moves in and shapes out.
//
// The rules of the wire are in deformation_service.proto. How they are kept:
//   - A message that was read is held until it can be taken; nothing is read meanwhile. EVERY takes
//   an
//     update when the one before it has started, LATEST at once, in the place of one that has not
//     started. An edit, and a bad update, is taken when everything before it is answered: answers
//     keep their order.
//   - One job at a time. It starts when no answer waits for the write before it; with LATEST also
//   when
//     the shape that waits may be replaced.
//   - An edit changes the set of this stream only. What the session stores stays as it is.
//   - Targets given as positions leave the angles and scales of oriented handles as they are.
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
