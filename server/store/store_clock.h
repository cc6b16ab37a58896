// StoreClock: the time by which sessions expire. It is the store's, so that a server whose own
// clock is wrong ends nobody's session.
#pragma once

#include <chrono>
#include <optional>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/runtime/clock.h"
#include "server/store/store.h"

namespace arap::store {

// Thread-safe. Between two answers of the store time goes on by the steady clock of this machine,
// which never jumps. A store without a clock of its own has that of this machine as it was when the
// StoreClock was made.
class StoreClock {
 public:
  using Wall = runtime::Clock::Wall;
  using Steady = runtime::Clock::Steady;

  // Both outlive it.
  StoreClock(SpecStore& specs, const runtime::Clock& clock)
      : specs_(specs), clock_(clock), origin_(Origin(clock.WallNow(), clock.SteadyNow())) {}

  // Asks the store for the time unless it has said it some seconds ago. Answers the store's fault
  // while the store has never said it; later the steady clock is good enough.
  Status Refresh() {
    {
      const MutexLock lock(&mutex_);
      if (asked_ && clock_.SteadyNow() - *asked_ < kAskEvery) return {};
    }
    const Steady before = clock_.SteadyNow();
    const auto time = specs_.Time();
    const Steady after = clock_.SteadyNow();
    const MutexLock lock(&mutex_);
    if (!time) return asked_ ? Status() : Fail(time.error());
    asked_ = after;
    ours_ = !time->has_value();
    if (!ours_) origin_ = Origin(**time, before + (after - before) / 2);
    return {};
  }

  Wall Now() const {
    const MutexLock lock(&mutex_);
    return origin_ +
           std::chrono::duration_cast<Wall::duration>(clock_.SteadyNow().time_since_epoch());
  }

  // By how much the clock of this machine was set since, if it is that of the store and that is
  // much: expiries that are stored are wrong by so much. They are to be moved before Adopt.
  std::chrono::milliseconds Jump() const {
    using std::chrono::milliseconds;
    const auto jump = std::chrono::duration_cast<milliseconds>(clock_.WallNow() - Now());
    const MutexLock lock(&mutex_);
    return ours_ && std::chrono::abs(jump) > kJump ? jump : milliseconds::zero();
  }
  void Adopt(std::chrono::milliseconds jump) {
    const MutexLock lock(&mutex_);
    origin_ += jump;
  }

 private:
  static constexpr std::chrono::seconds kAskEvery{10};
  // Clocks that are kept in step are moved by less.
  static constexpr std::chrono::seconds kJump{10};

  static Wall Origin(Wall wall, Steady steady) {
    return wall - std::chrono::duration_cast<Wall::duration>(steady.time_since_epoch());
  }

  SpecStore& specs_;
  const runtime::Clock& clock_;
  mutable Mutex mutex_;
  // The store's time when the steady clock stands at its beginning.
  Wall origin_ ABSL_GUARDED_BY(mutex_);
  std::optional<Steady> asked_ ABSL_GUARDED_BY(mutex_);
  bool ours_ ABSL_GUARDED_BY(mutex_) = true;  // the clock is that of this machine
};

}  // namespace arap::store
