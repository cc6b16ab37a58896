// Readiness: whether new work should come to this server, and why not.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/runtime/clock.h"
#include "server/runtime/worker_pool.h"
#include "server/store/store.h"

namespace arap::host {

struct Verdict {
  enum class State {
    kReady,
    kDraining,  // goes away: send no new sessions, let the streams be
    kStuck,     // a lane does not get on
    kStore,     // the store fails or does not answer
    kDeaf,      // nobody is let in any more
  };
  State state = State::kReady;
  // Sentences without secrets; empty when ready and nothing is wrong with the store.
  std::string why;

  bool ready() const { return state == State::kReady; }
};

// "ready", "draining", "stuck", "store", "deaf".
const char* StateName(Verdict::State state);

// Thread-safe.
class Readiness {
 public:
  using LaneStats = std::function<runtime::PoolStats()>;

  // `stuck_after` is the patience with lanes and store. `clock` outlives this.
  Readiness(std::chrono::milliseconds stuck_after, const runtime::Clock& clock)
      : stuck_after_(stuck_after), clock_(clock) {}

  // Before the first Check. A lane is stuck when one of its jobs runs for longer than the patience,
  // or one waits for that long while none has ended. Not for lanes whose jobs may be long.
  void WatchLane(std::string name, LaneStats stats);
  // Before the first Probe. `probe` may block: only Probe calls it. `weaknesses` never blocks: a
  // grave one is a reason not to be ready, the others are told beside "ready".
  using Weaknesses = std::function<std::vector<store::Weakness>()>;
  void WatchStore(std::function<Status()> probe, Weaknesses weaknesses = {}) {
    probe_ = std::move(probe);
    weaknesses_ = std::move(weaknesses);
  }

  // Asks the store and keeps the answer. To be called every second or so, from one thread.
  void Probe();

  // What became of knocking at our own doors, as clients do.
  void TellDialled(const Status& dialled);
  // Whether nobody has been let in for longer than the patience.
  bool IsDeaf() const;

  // From now on draining, whatever else.
  void AnnounceStop();

  // Never blocks. A probe that runs for longer than the patience counts as failed.
  Verdict Check() const;

 private:
  struct Lane {
    std::string name;
    LaneStats stats;
  };

  const std::chrono::milliseconds stuck_after_;
  const runtime::Clock& clock_;
  std::vector<Lane> lanes_;
  std::function<Status()> probe_;
  Weaknesses weaknesses_;
  mutable Mutex mutex_;
  bool draining_ ABSL_GUARDED_BY(mutex_) = false;
  std::optional<runtime::Clock::Steady> probing_since_ ABSL_GUARDED_BY(mutex_);
  // Empty: the last probe was good.
  std::string store_fault_ ABSL_GUARDED_BY(mutex_);
  std::optional<runtime::Clock::Steady> deaf_since_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::host
