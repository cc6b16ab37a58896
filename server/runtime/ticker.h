// Ticker: runs something again and again in a thread of its own.
#pragma once

#include <chrono>
#include <functional>
#include <thread>
#include <utility>

#include "core/base/mutex.h"

namespace arap::runtime {

// Calls `tick` a period after construction and a period after each return, never twice at the same
// time. Tests call what `tick` calls and need no ticker. `tick` must not throw and must not stop
// its own ticker.
class Ticker {
 public:
  // A period of 0 or less never ticks.
  Ticker(std::chrono::milliseconds period, std::function<void()> tick)
      : period_(period), tick_(std::move(tick)) {
    const MutexLock joining(&join_mutex_);
    if (period_.count() > 0) thread_ = std::thread([this] { Run(); });
  }
  // Stops.
  ~Ticker() { Stop(); }
  Ticker(const Ticker&) = delete;
  Ticker& operator=(const Ticker&) = delete;

  // Waits for a tick that runs; none starts afterwards. Harmless when repeated.
  void Stop() {
    {
      const MutexLock lock(&mutex_);
      stopped_ = true;
    }
    wake_.SignalAll();
    const MutexLock joining(&join_mutex_);
    if (thread_.joinable()) thread_.join();
  }

 private:
  void Run() {
    while (AwaitTick()) tick_();
  }
  // Waits for a period or for Stop: false when it has stopped.
  bool AwaitTick() {
    const auto next = std::chrono::steady_clock::now() + period_;
    const MutexLock lock(&mutex_);
    while (!stopped_) {
      if (wake_.WaitUntil(&mutex_, next)) return !stopped_;
    }
    return false;
  }

  const std::chrono::milliseconds period_;
  const std::function<void()> tick_;
  Mutex mutex_;
  CondVar wake_;
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  Mutex join_mutex_;
  std::thread thread_ ABSL_GUARDED_BY(join_mutex_);
};

}  // namespace arap::runtime
