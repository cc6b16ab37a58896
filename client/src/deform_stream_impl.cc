#include "client/src/deform_stream_impl.h"

#include <utility>

namespace arap::client {

using internal::FaultOf;
using internal::FromWire;

DeformStream::Impl::Impl(std::shared_ptr<internal::Channel> channel, const CallOptions& call,
                         const std::string& session_id)
    : channel_(std::move(channel)) {
  internal::Prepare(context_, call, session_id);
  stream_ = channel_->deformation().StreamDeform(&context_);
}

DeformStream::Impl::~Impl() {
  // gRPC wants every call finished, and a finish waits for the messages before it.
  if (end_) return;
  context_.TryCancel();
  v1::StreamDeformResponse response;
  while (Next(response)) {
  }
}

Status DeformStream::Impl::Open(const v1::OpenStream& open) {
  v1::StreamDeformRequest request;
  *request.mutable_open() = open;
  // The end of the stream explains a failed write.
  (void)Write(request);
  v1::StreamDeformResponse response;
  if (!Next(response)) {
    if (!*end_) return *end_;
    return Fail(FaultKind::kInternal, "the server ended the stream without opening it");
  }
  if (!response.has_opened()) {
    return Fail(FaultKind::kInternal, "the server answered before it opened the stream");
  }
  handle_set_ = FromWire(response.opened().handle_set());
  return {};
}

Status DeformStream::Impl::Write(const v1::StreamDeformRequest& request) {
  const std::lock_guard lock(write_mutex_);
  if (sending_closed_) return Fail(FaultKind::kProtocol, "sending on this stream was closed");
  if (finished_ || !stream_->Write(request)) {
    return Fail(FaultKind::kProtocol, "the stream is over; reading tells why");
  }
  return {};
}

Status DeformStream::Impl::WritesDone() {
  const std::lock_guard lock(write_mutex_);
  if (sending_closed_) return {};
  sending_closed_ = true;
  if (finished_ || !stream_->WritesDone()) {
    return Fail(FaultKind::kProtocol, "the stream is over; reading tells why");
  }
  return {};
}

bool DeformStream::Impl::Next(v1::StreamDeformResponse& response) {
  if (end_) return false;
  if (stream_->Read(&response)) return true;
  const std::lock_guard lock(write_mutex_);
  finished_ = true;
  const grpc::Status status = stream_->Finish();
  end_.emplace();
  if (!status.ok()) *end_ = Fail(FaultOf(status));
  return false;
}

Result<std::optional<StreamEvent>> DeformStream::Impl::Read() {
  v1::StreamDeformResponse response;
  if (!Next(response)) {
    if (!*end_) return Fail(end_->error());
    return std::optional<StreamEvent>();
  }
  switch (response.payload_case()) {
    case v1::StreamDeformResponse::kShape:
      return std::optional<StreamEvent>(FromWire(response.shape()));
    case v1::StreamDeformResponse::kError:
      return std::optional<StreamEvent>(
          UpdateError{response.error().sequence(), FaultOf(response.error().status())});
    case v1::StreamDeformResponse::kPong:
      return std::optional<StreamEvent>(Pong{response.pong().nonce()});
    case v1::StreamDeformResponse::kOpened:
    case v1::StreamDeformResponse::PAYLOAD_NOT_SET:
      break;
  }
  return Fail(FaultKind::kInternal, "the server sent a message that does not belong here");
}

}  // namespace arap::client
