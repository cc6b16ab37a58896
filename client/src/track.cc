// Session::DeformTrack: the frames of a track, each checked as it comes.
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <grpcpp/client_context.h>

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

  grpc::ClientContext context;
  internal::CallHeaders(id_, call.traceparent).AddTo(context);
  if (const auto deadline = internal::DeadlineOf(call, kNoLimit)) context.set_deadline(*deadline);
  const std::stop_callback cancel(call.stop, [&context] { context.TryCancel(); });
  internal::Impatience impatience(context, kWorkLimit);
  const auto reader = channel_->deformation().DeformTrack(&context, request);
  internal::ShapeQuestion asked{options, sizes_->OfSet(handle_set_id)};
  std::optional<Fault> stop;
  v1::DeformTrackResponse response;
  std::size_t frame = 0;
  const auto next = [&] { return impatience.Wait([&] { return reader->Read(&response); }); };
  // After a stop we still read to the end, so that the call can be finished.
  while (next()) {
    if (stop) continue;
    Result<Shape> shape = FrameOf(response, asked, frame++, frames.size());
    if (!shape) {
      stop = std::move(shape.error());
    } else if (!on_frame(*std::move(shape))) {
      stop = Fault(FaultKind::kCancelled, "The caller stopped the track.");
    }
    if (stop) context.TryCancel();
  }
  const grpc::Status status = reader->Finish();
  if (stop) return Fail(*std::move(stop));
  if (impatience.is_lost()) {
    return Fail(FaultKind::kDeadlineExceeded,
                fmt::format("Frame {} of the track did not come within {:g} s.", frame,
                            std::chrono::duration<double>(kWorkLimit).count()));
  }
  if (!status.ok()) return Fail(convert::FaultOf(status));
  if (frame == frames.size()) return {};
  return Fail(internal::BadAnswer(
      fmt::format("The server ended the track after {} of {} frames.", frame, frames.size())));
}

}  // namespace arap::client
