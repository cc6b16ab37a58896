// Pacer: wakes whoever has something to do at a time, from a few threads of its own.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <queue>
#include <thread>
#include <vector>

#include "client/cli/load/schedule.h"
#include "core/base/mutex.h"

namespace arap::cli {

// The time of this process, from an origin that everything in it shares; it does not go back.
Moment Now();

// Thread-safe. Sleepers are numbers; number n is woken by thread n modulo `threads`, and each thread
// keeps its appointments in a heap, so that 10,000 of them cost what one costs and some 32 bytes each.
class Pacer {
 public:
  // `wake` is called with the number, without any lock held, never early. On Linux within some 50 µs
  // of its time on an idle processor: the slack of the threads' timers is turned off.
  Pacer(std::size_t threads, std::function<void(std::size_t)> wake);
  // Nobody is woken any more once this has begun.
  ~Pacer();
  Pacer(const Pacer&) = delete;
  Pacer& operator=(const Pacer&) = delete;

  // Wakes `sleeper` at `when`. Who asks for several times is woken as often.
  void At(std::size_t sleeper, Moment when);

 private:
  struct Appointment {
    Moment when{0};
    std::size_t sleeper = 0;
    bool operator>(const Appointment& other) const { return when > other.when; }
  };
  struct Lane {
    Mutex mutex;
    CondVar changed;
    std::priority_queue<Appointment, std::vector<Appointment>, std::greater<>> appointments
        ABSL_GUARDED_BY(mutex);
    bool over ABSL_GUARDED_BY(mutex) = false;
    std::thread thread;
  };

  void Run(Lane& lane);

  const std::function<void(std::size_t)> wake_;
  std::vector<std::unique_ptr<Lane>> lanes_;
};

}  // namespace arap::cli
