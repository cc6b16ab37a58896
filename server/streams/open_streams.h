// OpenStreams: counts the streams and tracks of the server and tells them when it goes away.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/access/caller.h"
#include "server/runtime/clock.h"

namespace arap::app {

// A call that lasts, a stream or a track, and can be asked to end.
class LongCall {
 public:
  virtual ~LongCall() = default;
  // Finishes the frame in work, then ends with `reason`. Returns at once. Only the first call
  // counts.
  virtual void End(Fault reason) = 0;
  // Looks whether it has been idle for too long. Returns at once.
  virtual void Sweep(runtime::Clock::Steady now) { static_cast<void>(now); }
};

// Thread-safe.
class OpenStreams {
 public:
  explicit OpenStreams(std::size_t limit) : limit_(limit) {}

  // kLimitExceeded when `limit` streams or max_streams of the caller's owner or of its gateway are
  // open, kDraining after Drain.
  Status Add(const std::shared_ptr<LongCall>& call, const Caller& caller);
  // Harmless for a call that was refused.
  void Remove(const LongCall* call);
  // Ends all streams with kDraining and refuses new ones.
  void Drain();
  // Sweeps every stream.
  void Sweep(runtime::Clock::Steady now);
  std::size_t count() const;

 private:
  struct Entry {
    std::weak_ptr<LongCall> call;
    std::string owner;
  };
  using Alive = std::vector<std::shared_ptr<LongCall>>;

  Alive AliveOnes() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::size_t limit_;
  mutable Mutex mutex_;
  bool draining_ ABSL_GUARDED_BY(mutex_) = false;
  std::map<const LongCall*, Entry> calls_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, std::size_t> by_owner_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::app
