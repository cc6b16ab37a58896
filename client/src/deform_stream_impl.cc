#include "client/src/deform_stream_impl.h"

#include <utility>

#include <fmt/format.h>

namespace arap::client {

using internal::FaultOf;
using internal::FromWire;

namespace {

std::optional<std::chrono::system_clock::time_point> DeadlineOf(const CallOptions& call) {
  if (!call.timeout) return std::nullopt;
  return std::chrono::system_clock::now() + *call.timeout;
}

auto NotGrown(std::uint64_t sequence) {
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("The sequence {} has not grown; on a stream that resumes it tells "
                                "the answers apart.",
                                sequence))
                  .Field("sequence"));
}

auto Over() { return Fail(FaultKind::kProtocol, "the stream is over; reading tells why"); }

}  // namespace

DeformStream::Impl::Impl(std::shared_ptr<internal::Channel> channel, const StreamOptions& options,
                         const CallOptions& call, v1::OpenStream open)
    : options_(options),
      deadline_(DeadlineOf(call)),
      open_message_(std::move(open)),
      channel_(std::move(channel)) {
  if (resumes()) log_.emplace(options_.delivery == Delivery::kLatest);
  if (options_.heartbeat.count() > 0) {
    watch_ = std::jthread([this](const std::stop_token& stop) { Watch(stop); });
  }
}

DeformStream::Impl::~Impl() { Cancel(); }

Status DeformStream::Impl::Open() {
  bool lost = false;
  auto opened = OpenCall(&lost);
  if (!opened) return Fail(std::move(opened.error()));
  handle_set_ = *std::move(opened);
  const std::lock_guard lock(mutex_);
  open_ = true;
  return {};
}

Status DeformStream::Impl::Send(v1::StreamDeformRequest request) {
  std::unique_lock lock(mutex_);
  if (sending_closed_) return Fail(FaultKind::kProtocol, "sending on this stream was closed");
  if (options_.delivery == Delivery::kEvery) {
    changed_.wait(lock, [this] { return open_ || end_ || cancelled_; });
  }
  if (end_ || cancelled_) return Over();
  if (log_ && !log_->Sent(request)) return NotGrown(internal::SequenceOf(request));
  if (!open_) return {};
  const std::shared_ptr<Call> call = call_;
  call->Push(std::move(request));
  lock.unlock();
  // What a lost call has not sent is said again on the next one.
  if (!call->WaitSent() && !resumes()) return Over();
  return {};
}

Status DeformStream::Impl::Ping(std::uint64_t nonce) {
  const std::lock_guard lock(mutex_);
  if (sending_closed_) return Fail(FaultKind::kProtocol, "sending on this stream was closed");
  if (end_ || cancelled_) return Over();
  PushPing(nonce);
  return {};
}

Status DeformStream::Impl::CloseSending() {
  const std::lock_guard lock(mutex_);
  if (std::exchange(sending_closed_, true)) return {};
  if (end_ || cancelled_) return Over();
  if (open_) call_->PushEnd();
  return {};
}

void DeformStream::Impl::Cancel() {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
  if (call_) call_->Cancel();
  changed_.notify_all();
}

void DeformStream::Impl::End(Status status) {
  const std::lock_guard lock(mutex_);
  end_ = std::move(status);
  open_ = false;
  changed_.notify_all();
}

bool DeformStream::Impl::Next(Call& call, v1::StreamDeformResponse* response) {
  const auto wait = [this](bool waiting) {
    const std::lock_guard lock(mutex_);
    waiting_ = waiting;
    heard_ = Clock::now();
  };
  wait(true);
  const bool got = call.Read(response);
  wait(false);
  return got;
}

Status DeformStream::Impl::EndOf(const Call& call, bool* lost) {
  const std::lock_guard lock(mutex_);
  *lost = silent_ || internal::IsLost(call.status());
  if (*lost && cancelled_) {
    *lost = false;
    return Fail(FaultKind::kCancelled, "the stream was cancelled");
  }
  if (*lost && silent_) {
    Fault fault(FaultKind::kDraining,
                fmt::format("Nothing was heard from the server for {:g} s.",
                            std::chrono::duration<double>(options_.silence).count()));
    return Fail(fault.Detail(std::string(kGrpcCodeDetail), "UNAVAILABLE"));
  }
  if (!call.status().ok()) return Fail(FaultOf(call.status()));
  return {};
}

Result<std::optional<StreamEvent>> DeformStream::Impl::Read() {
  for (;;) {
    std::shared_ptr<Call> call;
    {
      const std::lock_guard lock(mutex_);
      if (end_ && !*end_) return Fail(end_->error());
      if (end_) return std::optional<StreamEvent>();
      call = call_;
    }
    v1::StreamDeformResponse response;
    bool lost = false;
    Status end;
    if (Next(*call, &response)) {
      auto event = EventOf(response);
      if (event && *event) return event;
      if (event) continue;
      call->Cancel();
      lost = internal::IsFull(event.error());
      end = Fail(std::move(event.error()));
    } else {
      end = EndOf(*call, &lost);
    }
    call.reset();
    if (lost && resumes()) {
      auto resumed = Resume(std::move(end.error()));
      if (resumed) return std::optional<StreamEvent>(*std::move(resumed));
      end = Fail(std::move(resumed.error()));
    }
    End(std::move(end));
  }
}

Result<std::optional<StreamEvent>> DeformStream::Impl::EventOf(
    const v1::StreamDeformResponse& response) {
  const auto known = [this](std::uint64_t sequence, bool good) {
    const std::lock_guard lock(mutex_);
    const bool seen = log_ && !log_->Answered(sequence, good);
    if (trouble_ && (good || !seen) && sequence >= trouble_->last_said) trouble_.reset();
    return seen;
  };
  switch (response.payload_case()) {
    case v1::StreamDeformResponse::kShape:
      if (known(response.shape().sequence(), true)) return std::optional<StreamEvent>();
      return std::optional<StreamEvent>(FromWire(response.shape()));
    case v1::StreamDeformResponse::kError: {
      Fault fault = FaultOf(response.error().status());
      // What had worked does not work again: the shapes would be others.
      if (known(response.error().sequence(), false)) return Fail(std::move(fault));
      return std::optional<StreamEvent>(UpdateError{response.error().sequence(), std::move(fault)});
    }
    case v1::StreamDeformResponse::kPong:
      return TakePong();
    case v1::StreamDeformResponse::kOpened:
    case v1::StreamDeformResponse::PAYLOAD_NOT_SET:
      break;
  }
  return Fail(FaultKind::kInternal, "the server sent a message that does not belong here");
}

}  // namespace arap::client
