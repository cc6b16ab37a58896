// The calls on a session that deform: one shape, or a track of them.
#include <utility>

#include "arap/client/session.h"
#include "client/src/channel.h"
#include "client/src/convert.h"

namespace arap::client {

using internal::Append;
using internal::FromWire;

namespace {

void ToWire(const TrackFrame& frame, v1::TrackFrame* out) {
  Append(std::span(frame.positions), out->mutable_positions());
  Append(std::span(frame.angles_radians), out->mutable_angles_radians());
  Append(std::span(frame.scales), out->mutable_scales());
}

}  // namespace

Result<Shape> Session::Deform(const std::string& handle_set_id,
                              std::span<const HandleTarget> targets, const DeformOptions& options,
                              std::span<const double> pick_points, const CallOptions& call) const {
  v1::DeformRequest request;
  request.set_session_id(id_);
  request.set_handle_set_id(handle_set_id);
  for (const HandleTarget& target : targets) internal::ToWire(target, request.add_targets());
  internal::ToWire(options, request.mutable_options());
  Append(pick_points, request.mutable_pick_points());
  return internal::Call(channel_->deformation(), &v1::DeformationService::Stub::Deform, request,
                        call, id_)
      .map([](const v1::DeformResponse& response) { return FromWire(response.shape()); });
}

Status Session::DeformTrack(const std::string& handle_set_id,
                            std::span<const std::string> handle_ids,
                            std::span<const TrackFrame> frames, const DeformOptions& options,
                            const FrameCallback& on_frame, const CallOptions& call) const {
  v1::DeformTrackRequest request;
  request.set_session_id(id_);
  request.set_handle_set_id(handle_set_id);
  request.mutable_handle_ids()->Add(handle_ids.begin(), handle_ids.end());
  for (const TrackFrame& frame : frames) ToWire(frame, request.add_frames());
  internal::ToWire(options, request.mutable_options());

  grpc::ClientContext context;
  internal::Prepare(context, call, id_);
  const auto reader = channel_->deformation().DeformTrack(&context, request);
  bool stopped = false;
  v1::DeformTrackResponse response;
  while (reader->Read(&response)) {
    // After a stop we still read to the end, so that the call can be finished.
    if (!stopped && !on_frame(FromWire(response.shape()))) {
      stopped = true;
      context.TryCancel();
    }
  }
  const grpc::Status status = reader->Finish();
  if (stopped) return Fail(FaultKind::kCancelled, "the caller stopped the track");
  if (!status.ok()) return Fail(internal::FaultOf(status));
  return {};
}

}  // namespace arap::client
