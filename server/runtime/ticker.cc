#include "server/runtime/ticker.h"

#include <utility>

namespace arap::runtime {

Ticker::Ticker(std::chrono::milliseconds period, std::function<void()> tick)
    : period_(period), tick_(std::move(tick)) {
  const MutexLock joining(&join_mutex_);
  if (period_.count() > 0) thread_ = std::thread([this] { Run(); });
}

Ticker::~Ticker() { Stop(); }

void Ticker::Stop() {
  {
    const MutexLock lock(&mutex_);
    stopped_ = true;
  }
  wake_.SignalAll();
  const MutexLock joining(&join_mutex_);
  if (thread_.joinable()) thread_.join();
}

bool Ticker::AwaitTick() {
  const auto next = std::chrono::steady_clock::now() + period_;
  const MutexLock lock(&mutex_);
  while (!stopped_) {
    if (wake_.WaitUntil(&mutex_, next)) return !stopped_;
  }
  return false;
}

void Ticker::Run() {
  while (AwaitTick()) tick_();
}

}  // namespace arap::runtime
