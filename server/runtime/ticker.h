// Ticker: runs something again and again in a thread of its own.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

#include "core/base/mutex.h"

namespace arap::runtime {

// Calls `tick` a period after construction and a period after each return, never twice at the same
// time. Tests call what `tick` calls and need no ticker. `tick` must not throw and must not stop
// its own ticker.
class Ticker {
 public:
  // A period of 0 or less never ticks.
  Ticker(std::chrono::milliseconds period, std::function<void()> tick);
  // Stops.
  ~Ticker();
  Ticker(const Ticker&) = delete;
  Ticker& operator=(const Ticker&) = delete;

  // Waits for a tick that runs; none starts afterwards. Harmless when repeated.
  void Stop();

 private:
  void Run();
  // Waits for a period or for Stop: false when it has stopped.
  bool AwaitTick();

  const std::chrono::milliseconds period_;
  const std::function<void()> tick_;
  Mutex mutex_;
  CondVar wake_;
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  Mutex join_mutex_;
  std::thread thread_ ABSL_GUARDED_BY(join_mutex_);
};

}  // namespace arap::runtime
