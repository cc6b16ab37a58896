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
  // Both outlive it.
  StoreClock(SpecStore& specs, const runtime::Clock& clock);

  // Asks the store for the time unless it has said it some seconds ago. Answers the store's fault
  // while the store has never said it; later the steady clock is good enough.
  Status Refresh();

  runtime::Clock::Wall Now() const;

  // By how much the clock of this machine was set since, if it is that of the store and that is
  // much: expiries that are stored are wrong by so much. They are to be moved before Adopt.
  std::chrono::milliseconds Jump() const;
  void Adopt(std::chrono::milliseconds jump);

 private:
  SpecStore& specs_;
  const runtime::Clock& clock_;
  mutable Mutex mutex_;
  // The store's time when the steady clock stands at its beginning.
  runtime::Clock::Wall origin_ ABSL_GUARDED_BY(mutex_);
  std::optional<runtime::Clock::Steady> asked_ ABSL_GUARDED_BY(mutex_);
  bool ours_ ABSL_GUARDED_BY(mutex_) = true;  // the clock is that of this machine
};

}  // namespace arap::store
