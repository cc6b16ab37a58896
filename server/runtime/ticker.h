// Ticker: runs something again and again in a thread of its own.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

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

  const std::chrono::milliseconds period_;
  const std::function<void()> tick_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopped_ = false;  // guarded by mutex_
  std::mutex join_mutex_;
  std::thread thread_;  // guarded by join_mutex_
};

}  // namespace arap::runtime
