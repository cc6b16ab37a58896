// SessionRegistry: the sessions by owner and id — in memory those that somebody used, all of them
// in the store.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/limits.h"
#include "core/base/mutex.h"
#include "server/access/caller.h"
#include "server/budget/owner_quotas.h"
#include "server/runtime/clock.h"
#include "server/sessions/session.h"
#include "server/sessions/session_locks.h"
#include "server/store/store.h"
#include "server/store/store_clock.h"

namespace arap::app {

// Sessions in the order of their ids.
struct SessionPage {
  std::vector<SessionView> sessions;  // expired ones are left out
  std::string next_token;             // empty at the end
};

// Thread-safe. Everything but Peek and Glance may wait for the store: not for the interactive lane.
// An expired session is gone for every caller. Every call may answer the store's faults,
// kStoreUnavailable and kDataLoss; nothing has changed then.
//
// Which call waits for which:
//   - Each session has a lock of its own (session_locks.h). Whoever creates, loads, changes,
//     deletes or ends a session holds it from the first look at the store until memory says the
//     same as the store. So a record that was read cannot come back into memory after its removal,
//     of two that create one id the second sees the first, and a change either precedes a removal
//     or finds the session gone.
//   - A thread holds one such lock at most. A call on one session never waits for another session's
//     store, except to end expired sessions when a quota seems full, and except for the last places
//     of a quota (owner_quotas.h).
//   - Looking a session up takes no lock while memory is up to date: always where this process
//     alone has the records, else when the version in the store is the one in memory.
//   - Processes that share a store compare and put: a change that finds another revision than it
//     began with is done again on what is stored now.
//   - mutex_ guards the map alone, for moments; no store is asked under it.
class SessionRegistry {
 public:
  // All outlive the registry. Records count in `memory`. `released` hears the last record of every
  // session that has ended here, in the thread that ended it; it must not call the registry, except
  // InUse.
  SessionRegistry(const Limits& limits, const runtime::Clock& clock, store::SpecStore& store,
                  DerivedCache& memory, std::function<void(const store::SessionRecord&)> released);

  // Opens a session; a ttl of 0 is the default ttl. With an equal spec under the id, answers that
  // session and extends its life. Faults: kInvalidName, kInvalidOption, kAlreadyExists,
  // kLimitExceeded.
  Result<SessionView> Create(const Caller& caller, SessionSpec spec);

  // The session, its life extended; read from the store when it is not in memory or has changed
  // there. kNotFound.
  Result<std::shared_ptr<Session>> Use(const std::string& owner, const std::string& id);
  // The same without asking the store: null when it would have to be asked. Never blocks.
  std::shared_ptr<Session> Peek(const std::string& owner, const std::string& id);
  // What memory has of it, which may be out of date, its life not extended: to estimate by.
  std::shared_ptr<const Session> Glance(const std::string& owner, const std::string& id) const {
    return InMemory({owner, id});
  }

  // What it holds, its life not extended. kNotFound.
  Result<SessionView> View(const std::string& owner, const std::string& id);

  // A page of at most `size` sessions (0: the default) after `token`. kInvalidOption.
  Result<SessionPage> List(const std::string& owner, std::size_t size, const std::string& token);

  // Ends the session. kNotFound.
  Status Delete(const std::string& owner, const std::string& id);

  // Changes the record and stores it before it answers. `edit` gets a copy and says whether it has
  // changed it; it is called again when another process was faster, 16 times at most, and must not
  // call the registry.
  // Returns the record in force. Faults: kNotFound when the session has ended, those of `edit`, and
  // kLimitExceeded when the caller's owner has no room for the meshes or handle sets that were
  // added, or no memory for the record; kStoreUnavailable when another process was faster each time.
  using Edit = std::function<Result<bool>(store::SessionRecord&)>;
  Result<Session::Record> Change(const Caller& caller, Session& session, const Edit& edit);

  // Whether the caller's owner has room for `more` in the store, to be asked before blobs are put
  // there: one that a record then cannot name would lie there until a sweep. kLimitExceeded.
  Status MayStore(const Caller& caller, const store::Usage& more);

  // Whether a session in memory has a mesh with this blob.
  bool InUse(const std::string& owner, const std::string& blob) const;
  std::size_t in_memory() const;
  // What the records of these take.
  std::size_t bytes() const;
  // Calls that wait for another call on the same session.
  std::size_t waiting() const { return locks_.waiting(); }

  // Stores expiries that have moved and ends what has expired; sessions that a call is busy with
  // are left for the next sweep. To be called every second or so. Answers the store's fault if it
  // failed; the next sweep tries again.
  Status Sweep();

 private:
  using Sessions = std::map<store::SessionKey, std::shared_ptr<Session>>;
  using Found = std::shared_ptr<Session>;
  using Held = SessionLocks::Held;
  // What to do about sessions whose lock somebody holds.
  enum class Busy { kWait, kSkip };

  Found InMemory(const store::SessionKey& key) const;
  std::vector<Found> InMemory(const std::function<bool(const Session&)>& wanted) const;
  // Whether memory is up to date; `session` is there and has not expired.
  Result<bool> IsCurrent(const Session& session);
  Result<Found> Find(const store::SessionKey& key);

  // These need the lock of the session.
  Result<Found> Find(const Held& held, const store::SessionKey& key);
  Result<Found> Load(const Held& held, const store::SessionKey& key, Found session);
  Result<SessionView> Create(const Held& held, const Caller& caller, const SessionSpec& spec);
  // Memory for a record that is about to take the place of another.
  Result<Session::Room> RoomFor(const Caller& caller, const store::SessionRecord& before,
                                const store::SessionRecord& after);
  // Takes it out of memory and ends it; harmless when it is not there any more.
  void Drop(const Held& held, const Found& session);
  // Drops a session that has expired here, and removes it from the store unless another process has
  // extended it.
  Status Expire(const Held& held, const Found& session);
  Status StoreExpiry(const Held& held, const Found& session);
  // Keeps the store's time. When the clock of this machine was set, and it is the store's, what is
  // stored is moved with it, so that nobody's life becomes shorter.
  Status FollowClock();

  // Ends what has expired in memory, of one owner or (null) of all.
  Status ExpireAll(const std::string* owner, Busy busy);

  const Limits& limits_;
  const runtime::Clock& clock_;
  store::SpecStore& store_;
  DerivedCache& memory_;
  store::StoreClock time_;  // by which sessions expire in the store
  const std::function<void(const store::SessionRecord&)> released_;
  SessionLocks locks_;
  OwnerQuotas quotas_;
  mutable Mutex mutex_;
  Sessions sessions_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::app
