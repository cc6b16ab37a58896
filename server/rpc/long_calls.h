// The calls that last, over gRPC: a live stream, a track, watching a job and fetching its result.
// Each moves the bytes; the rules of a stream are in deformation_service.proto for clients and in
// server/streams/stream_policy.h for how they are kept.
#pragma once

#include <grpcpp/support/server_callback.h>

namespace arap::app {
struct Engine;
}
namespace arap::v1 {
class DeformTrackRequest;
class DeformTrackResponse;
class DownloadResultRequest;
class DownloadResultResponse;
class StreamDeformRequest;
class StreamDeformResponse;
class WatchJobRequest;
class WatchJobResponse;
}  // namespace arap::v1

namespace arap::rpc {

struct Identity;

// The reactor of a new call, which CallerOf may refuse; it owns itself until the call is done.
grpc::ServerBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse>* StreamDeform(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context);

// The same for a whole track of targets in, its frames out. All frames are checked before the first
// is answered, except for what only the solution shows (CONFLICTING_HANDLES, NUMERICAL): that ends
// the track at its frame. One frame is computed while the one before it is written; a client that
// does not read costs one waiting frame and no thread, and is cut off after max_stream_idle. The
// one message that comes in is read when CallerOf has let the call in.
grpc::ServerBidiReactor<v1::DeformTrackRequest, v1::DeformTrackResponse>* DeformTrack(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context);

// How a job stands: at once, when it changes, and with every sweep, until it has ended.
grpc::ServerBidiReactor<v1::WatchJobRequest, v1::WatchJobResponse>* WatchJob(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context);

// The result of a job in pieces, each sent when the one before it was written.
grpc::ServerBidiReactor<v1::DownloadResultRequest, v1::DownloadResultResponse>* DownloadResult(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context);

}  // namespace arap::rpc
