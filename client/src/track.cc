// Session::DeformTrack: the frames of a track, each checked as it comes.
#include <chrono>
#include <stop_token>
#include <utility>

#include <fmt/format.h>

#include "arap/client/session.h"
#include "client/src/answers.h"
#include "client/src/calls.h"
#include "client/src/channel.h"
#include "core/base/try.h"
#include "proto/convert/deform.h"

namespace arap::client {
namespace {

// The next frame, which has to be the one of this number. The first says which vertices they are of.
Result<Shape> FrameOf(const v1::DeformTrackResponse& response, internal::ShapeQuestion& asked,
                      std::size_t frame, std::size_t frames) {
  const v1::Shape& shape = response.shape();
  if (frame >= frames) {
    return Fail(internal::BadAnswer(
        fmt::format("The server answered more frames than the {} of the track.", frames)));
  }
  if (shape.sequence() != frame) {
    return Fail(internal::BadAnswer(fmt::format(
        "The server answered frame {} of the track where {} was due.", shape.sequence(), frame)));
  }
  if (frame == 0) {
    TRY(asked.vertices, internal::VerticesFromWire(response.vertices(), asked.options, asked.mesh));
  }
  const std::uint32_t every = asked.options.deform.measure_every;
  asked.measured = every > 0 && frame % every == 0;
  return internal::FromWire(shape, asked);
}

}  // namespace

Status Session::DeformTrack(const std::string& handle_set_id,
                            std::span<const std::string> handle_ids,
                            std::span<const std::vector<Target>> frames,
                            const ShapeOptions& options, const FrameCallback& on_frame,
                            const CallOptions& call) const {
  v1::DeformTrackRequest request;
  request.set_session_id(id_);
  request.set_handle_set_id(handle_set_id);
  request.mutable_handle_ids()->Add(handle_ids.begin(), handle_ids.end());
  for (const std::vector<Target>& frame : frames) {
    convert::ToWire(std::span<const Target>(frame), request.add_frames());
  }
  internal::ToWire(options, request.mutable_options());

  const internal::CallHeaders headers(id_, call.traceparent);
  const auto track = internal::PiecesCall<v1::DeformTrackResponse>::Make();
  const internal::Attempt attempt{headers, internal::DeadlineOf(call, kNoLimit), call.stop};
  attempt.Prepare(track->context());
  const std::stop_callback cancel(call.stop, [&track] { track->Cancel(); });
  channel_->deformation().async()->DeformTrack(&track->context(), &request, track.get());
  track->Start();
  internal::ShapeQuestion asked{options, sizes_->OfSet(handle_set_id)};
  v1::DeformTrackResponse response;
  std::size_t frame = 0;
  while (track->Read(&response, std::chrono::steady_clock::now() + kWorkLimit)) {
    TRY(Shape shape, FrameOf(response, asked, frame++, frames.size()));
    if (!on_frame(std::move(shape))) {
      return Fail(FaultKind::kCancelled, "The caller stopped the track.");
    }
  }
  if (track->is_late()) {
    return Fail(FaultKind::kDeadlineExceeded,
                fmt::format("Frame {} of the track did not come within {:g} s.", frame,
                            std::chrono::duration<double>(kWorkLimit).count()));
  }
  if (!track->status().ok()) return Fail(convert::FaultOf(track->status()));
  if (frame == frames.size()) return {};
  return Fail(internal::BadAnswer(
      fmt::format("The server ended the track after {} of {} frames.", frame, frames.size())));
}

}  // namespace arap::client
