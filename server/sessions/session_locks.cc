#include "server/sessions/session_locks.h"

namespace arap::app {

SessionLocks::Held SessionLocks::Take(const store::SessionKey& key) {
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

std::optional<SessionLocks::Held> SessionLocks::TryTake(const store::SessionKey& key) {
  const MutexLock lock(&mutex_);
  const auto at = locks_.try_emplace(key).first;
  if (at->second.taken || at->second.waiting > 0) return std::nullopt;
  at->second.taken = true;
  return Held(this, at);
}

std::size_t SessionLocks::waiting() const {
  const MutexLock lock(&mutex_);
  return waiting_;
}

void SessionLocks::Release(Held::Locks::iterator at) {
  const MutexLock lock(&mutex_);
  at->second.taken = false;
  if (at->second.waiting == 0) {
    locks_.erase(at);
  } else {
    at->second.freed.Signal();
  }
}

}  // namespace arap::app
