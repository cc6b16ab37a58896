// SessionLocks: one lock per session, whether the session is in memory, only stored or not there
// yet.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include "core/base/mutex.h"
#include "server/store/store.h"

namespace arap::app {

// Thread-safe. Takes memory only for the locks that somebody holds or waits for.
class SessionLocks {
 public:
  // The lock of one session, until this ends. Not recursive, and a thread holds one at most: two
  // threads that each waited for the other's second lock would wait for ever.
  class Held {
   public:
    Held(Held&& other) noexcept : locks_(std::exchange(other.locks_, nullptr)), at_(other.at_) {}
    Held& operator=(Held&&) = delete;
    ~Held() {
      if (locks_ != nullptr) locks_->Release(at_);
    }

   private:
    friend class SessionLocks;
    struct Lock {
      bool taken = false;
      std::size_t waiting = 0;
      CondVar freed;
    };
    using Locks = std::map<store::SessionKey, Lock>;
    Held(SessionLocks* locks, Locks::iterator at) : locks_(locks), at_(at) {}

    SessionLocks* locks_;
    Locks::iterator at_;
  };

  // Waits for whoever holds it.
  Held Take(const store::SessionKey& key) {
    const MutexLock lock(&mutex_);
    const auto at = locks_.try_emplace(key).first;
    // One that is freed stays in the map while somebody waits for it.
    ++at->second.waiting;
    ++waiting_;
    while (at->second.taken) at->second.freed.Wait(&mutex_);
    --at->second.waiting;
    --waiting_;
    at->second.taken = true;
    return Held(this, at);
  }
  // Nothing when somebody holds it.
  std::optional<Held> TryTake(const store::SessionKey& key) {
    const MutexLock lock(&mutex_);
    const auto at = locks_.try_emplace(key).first;
    if (at->second.taken || at->second.waiting > 0) return std::nullopt;
    at->second.taken = true;
    return Held(this, at);
  }

  // How many calls of Take wait.
  std::size_t waiting() const {
    const MutexLock lock(&mutex_);
    return waiting_;
  }

 private:
  void Release(Held::Locks::iterator at) {
    const MutexLock lock(&mutex_);
    at->second.taken = false;
    if (at->second.waiting == 0) {
      locks_.erase(at);
    } else {
      at->second.freed.Signal();
    }
  }

  mutable Mutex mutex_;
  Held::Locks locks_ ABSL_GUARDED_BY(mutex_);
  std::size_t waiting_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace arap::app
