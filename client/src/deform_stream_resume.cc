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
  v1::StreamDeformRequest request;
  *request.mutable_open() = open_message_;
  call->Push(std::move(request));
  std::shared_ptr<Call> old;  // may have to end yet, which is not to be waited for with mutex_ held
  {
    const std::lock_guard lock(mutex_);
    old = std::exchange(call_, call);
    silent_ = false;
    asked_ = Clock::now();
    std::erase(pings_, std::nullopt);  // lost with the call before
    if (cancelled_) call->Cancel();
  }
  old.reset();
  // The server may have much to compute before it has opened; meanwhile it answers pings.
  v1::StreamDeformResponse response;
  while (Next(*call, &response)) {
    if (response.has_opened()) return internal::FromWire(response.opened().handle_set());
    if (!response.has_pong()) {
      return Fail(FaultKind::kInternal, "the server answered before it opened the stream");
    }
    TakePong();
  }
  if (Status end = EndOf(*call, lost); !end) return Fail(std::move(end.error()));
  return Fail(FaultKind::kInternal, "the server ended the stream without opening it");
}

Result<StreamEvent> DeformStream::Impl::Resume(Fault fault) {
  bool silent = false;
  {
    const std::lock_guard lock(mutex_);
    open_ = false;
    silent = silent_;
  }
  // Who is lost again before it has caught up comes back neither at once nor for ever.
  const bool again = trouble_ && Clock::now() - trouble_->opened < options_.resume_within;
  if (!again) trouble_ = Trouble{Clock::now() + options_.resume_within, kFirstPause};
  for (std::uint32_t attempts = 1;; ++attempts) {
    if (again || attempts > 1) {
      if (Status waited = Pause(fault); !waited) return Fail(std::move(waited.error()));
    }
    if (silent) channel_ = channel_->Another();
    bool lost = false;
    auto opened = OpenCall(&lost);
    const std::lock_guard lock(mutex_);
    if (opened) {
      SayAgain();
      return Resumed{*std::move(opened), attempts};
    }
    fault = std::move(opened.error());
    if (!lost && !internal::IsFull(fault)) return Fail(std::move(fault));
    silent = silent_;
  }
}

Status DeformStream::Impl::Pause(const Fault& last) {
  milliseconds pause = Jittered(trouble_->pause);
  if (Clock::now() + pause >= trouble_->until) return Fail(last);
  trouble_->pause = std::min(2 * trouble_->pause, kLongestPause);
  if (deadline_) {
    const auto left = *deadline_ - std::chrono::system_clock::now();
    pause = std::min(pause, std::chrono::ceil<milliseconds>(left));
  }
  std::unique_lock lock(mutex_);
  if (!changed_.wait_for(lock, pause, [this] { return cancelled_; })) return {};
  return Fail(FaultKind::kCancelled, "the stream was cancelled");
}

void DeformStream::Impl::SayAgain() {
  std::vector<v1::StreamDeformRequest> messages = log_->Messages();
  if (messages.empty()) {
    trouble_.reset();
  } else {
    trouble_->opened = Clock::now();
    trouble_->last_said = internal::SequenceOf(messages.back());
  }
  for (v1::StreamDeformRequest& message : messages) call_->Push(std::move(message));
  open_ = true;
  for (const std::optional<std::uint64_t>& nonce : pings_) {
    if (nonce) SendPing(*nonce);
  }
  if (sending_closed_) call_->PushEnd();
  changed_.notify_all();
}

}  // namespace arap::client
