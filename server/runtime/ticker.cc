#include "server/runtime/ticker.h"

#include <utility>

namespace arap::runtime {

Ticker::Ticker(std::chrono::milliseconds period, std::function<void()> tick)
    : period_(period), tick_(std::move(tick)) {
  if (period_.count() > 0) thread_ = std::thread([this] { Run(); });
}

Ticker::~Ticker() { Stop(); }

void Ticker::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  wake_.notify_all();
  const std::lock_guard joining(join_mutex_);
  if (thread_.joinable()) thread_.join();
}

void Ticker::Run() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, period_, [this] { return stopped_; })) {
    lock.unlock();
    tick_();
    lock.lock();
  }
}

}  // namespace arap::runtime
