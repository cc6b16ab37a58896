// OpenStreams: counts the streams of the server and tells them when it goes away.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>

#include "core/base/result.h"

namespace arap::app {

// A stream that can be asked to end.
class OpenStream {
 public:
  virtual ~OpenStream() = default;
  // Finishes the frame in work, then ends with `reason`. Returns at once. Only the first call
  // counts.
  virtual void End(Fault reason) = 0;
};

// Thread-safe.
class OpenStreams {
 public:
  explicit OpenStreams(std::size_t limit) : limit_(limit) {}

  // kLimitExceeded when `limit` streams are open, kDraining after Drain.
  Status Add(const std::shared_ptr<OpenStream>& stream);
  // Harmless for a stream that was refused.
  void Remove(const OpenStream* stream);
  // Ends all streams with kDraining and refuses new ones.
  void Drain();
  std::size_t count() const;

 private:
  const std::size_t limit_;
  mutable std::mutex mutex_;
  bool draining_ = false;                                           // guarded by mutex_
  std::map<const OpenStream*, std::weak_ptr<OpenStream>> streams_;  // guarded by mutex_
};

}  // namespace arap::app
