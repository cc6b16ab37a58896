// How a DeformStream opens its calls, the first and those after a loss.
#include <algorithm>
#include <random>
#include <utility>

#include "client/src/deform_stream_impl.h"

namespace arap::client {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kFirstPause{50};
constexpr milliseconds kLongestPause{2'000};

// Clients of one server that died do not come back all at the same moment.
milliseconds Jittered(milliseconds pause) {
  std::random_device random;
  return milliseconds(
      std::uniform_int_distribution<milliseconds::rep>(pause.count() / 2, pause.count())(random));
}

}  // namespace

Result<HandleSetInfo> DeformStream::Impl::OpenCall(bool* lost) {
  const auto call = std::make_shared<Call>(*channel_, [this](grpc::ClientContext& context) {
    internal::Prepare(context, {}, open_message_.session_id());
    if (deadline_) context.set_deadline(*deadline_);
  });
  {
    const std::lock_guard lock(mutex_);
    call_ = call;
    silent_ = false;
    if (cancelled_) call->Cancel();
  }
  v1::StreamDeformRequest request;
  *request.mutable_open() = open_message_;
  call->Push(std::move(request));
  v1::StreamDeformResponse response;
  if (Next(*call, &response)) {
    if (response.has_opened()) return internal::FromWire(response.opened().handle_set());
    return Fail(FaultKind::kInternal, "the server answered before it opened the stream");
  }
  if (Status end = EndOf(*call, lost); !end) return Fail(std::move(end.error()));
  return Fail(FaultKind::kInternal, "the server ended the stream without opening it");
}

Result<StreamEvent> DeformStream::Impl::Resume() {
  {
    const std::lock_guard lock(mutex_);
    open_ = false;
  }
  const auto until = Clock::now() + options_.resume_within;
  milliseconds pause = kFirstPause;
  for (std::uint32_t attempts = 1;; ++attempts) {
    bool lost = false;
    auto opened = OpenCall(&lost);
    if (opened) {
      const std::lock_guard lock(mutex_);
      SayAgain();
      return Resumed{*std::move(opened), attempts};
    }
    // A server that is full may have room later.
    const bool full = Detail(opened.error(), kGrpcCodeDetail) == "RESOURCE_EXHAUSTED";
    if (!lost && !full) return Fail(std::move(opened.error()));
    const milliseconds wait = Jittered(pause);
    if (Clock::now() + wait >= until) return Fail(std::move(opened.error()));
    if (!Pause(wait)) return Fail(FaultKind::kCancelled, "the stream was cancelled");
    pause = std::min(2 * pause, kLongestPause);
  }
}

bool DeformStream::Impl::Pause(milliseconds pause) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_for(lock, pause, [this] { return cancelled_; });
}

void DeformStream::Impl::SayAgain() {
  for (v1::StreamDeformRequest& message : log_->Messages()) call_->Push(std::move(message));
  open_ = true;
  asked_ = Clock::now();
  for (const std::optional<std::uint64_t>& nonce : std::exchange(pings_, {})) {
    if (nonce) PushPing(nonce);
  }
  if (sending_closed_) call_->PushEnd();
  changed_.notify_all();
}

}  // namespace arap::client
