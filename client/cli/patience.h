// How long a command waits for its server.
#pragma once

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "arap/base/fault.h"

namespace arap::cli {

// Looks after a wait of the thread that makes it: calls `give_up`, once and from a thread of its
// own, when nothing new has come for `limit`, or at Ctrl-C; a second Ctrl-C ends the program. When
// `what` is not empty, a terminal is told of it and of how long it has taken. One at a time in the
// program; `give_up` is not called any more once this has gone.
class Patience {
 public:
  Patience(std::chrono::milliseconds limit, std::function<void()> give_up, std::string what = {});
  ~Patience();
  Patience(const Patience&) = delete;
  Patience& operator=(const Patience&) = delete;

  // Something new has come: the limit counts from now. From any thread.
  void Heard();

  // The fault of the work that was waited for: why it was given up, if it was, else `fault`.
  Fault Explain(Fault fault) const;

 private:
  enum class End { kNone, kInterrupted, kSilent };

  void Watch();

  const std::chrono::milliseconds limit_;
  const std::function<void()> give_up_;
  const std::string what_;
  std::atomic<std::int64_t> heard_;  // when, in nanoseconds of the steady clock
  std::atomic<End> end_ = End::kNone;
  const int wake_;  // an eventfd, which a signal handler may write to
  std::atomic<bool> done_ = false;
  struct sigaction before_ {};  // what SIGINT did
  std::thread watcher_;
};

}  // namespace arap::cli
