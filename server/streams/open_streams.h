// OpenStreams: counts the streams of the server and tells them when it goes away.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "server/access/caller.h"
#include "server/runtime/clock.h"

namespace arap::app {

// A stream that can be asked to end.
class OpenStream {
 public:
  virtual ~OpenStream() = default;
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

  // kLimitExceeded when `limit` streams or max_streams of the caller's owner are open, kDraining
  // after Drain.
  Status Add(const std::shared_ptr<OpenStream>& stream, const Caller& caller);
  // Harmless for a stream that was refused.
  void Remove(const OpenStream* stream);
  // Ends all streams with kDraining and refuses new ones.
  void Drain();
  // Sweeps every stream.
  void Sweep(runtime::Clock::Steady now);
  std::size_t count() const;

 private:
  std::vector<std::shared_ptr<OpenStream>> AliveLocked() const;

  const std::size_t limit_;
  mutable std::mutex mutex_;
  struct Entry {
    std::weak_ptr<OpenStream> stream;
    std::string owner;
  };
  // All below is guarded by mutex_.
  bool draining_ = false;
  std::map<const OpenStream*, Entry> streams_;
  std::map<std::string, std::size_t> by_owner_;
};

}  // namespace arap::app
