// Signs of life: the pings of a DeformStream, the user's and its own, and the thread that sends
// these. The server answers each, in order.
#include <algorithm>
#include <utility>

#include "client/src/deform_stream_impl.h"

namespace arap::client {

void DeformStream::Impl::SendPing(std::uint64_t nonce) {
  v1::StreamDeformRequest request;
  request.mutable_ping()->set_nonce(nonce);
  call_->Push(std::move(request));
}

void DeformStream::Impl::PushPing(std::optional<std::uint64_t> nonce) {
  // A call that is not open yet is asked our own only; the user's come behind them.
  pings_.insert(nonce || open_ ? pings_.end() : pings_.begin(), nonce);
  asked_ = Clock::now();
  if (open_ || !nonce) SendPing(nonce.value_or(0));
}

std::optional<StreamEvent> DeformStream::Impl::TakePong() {
  const std::lock_guard lock(mutex_);
  if (pings_.empty()) return std::nullopt;
  const std::optional<std::uint64_t> nonce = pings_.front();
  pings_.pop_front();
  if (!nonce) return std::nullopt;
  return Pong{*nonce};
}

void DeformStream::Impl::Watch(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const auto tick =
      std::max(std::min(options_.heartbeat, options_.silence) / 2, std::chrono::milliseconds(1));
  while (!changed_.wait_for(lock, stop, tick, [&] { return stop.stop_requested(); })) {
    if (!call_ || end_ || cancelled_) continue;
    const auto now = Clock::now();
    if (waiting_ && now - heard_ >= options_.silence) {
      silent_ = true;
      call_->Cancel();
      continue;
    }
    if (open_ && sending_closed_) continue;
    const bool asking = std::any_of(pings_.begin(), pings_.end(), [](auto& p) { return !p; });
    // While nobody reads, answers are not seen: we go on asking as long as the server takes it.
    if (asking && (waiting_ || !call_->is_clear())) continue;
    if (now - (waiting_ ? heard_ : asked_) >= options_.heartbeat) PushPing(std::nullopt);
  }
}

}  // namespace arap::client
