// SessionRegistry: the sessions by owner and id — in memory those that somebody used, all of them
// in the store.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "server/access/caller.h"
#include "server/budget/limits.h"
#include "server/runtime/clock.h"
#include "server/sessions/session.h"
#include "server/store/spec_store.h"

namespace arap::app {

// Sessions in the order of their ids.
struct SessionPage {
  std::vector<SessionView> sessions;  // expired ones are left out
  std::string next_token;             // empty at the end
};

// Thread-safe. Everything but Peek may wait for the store: not for the interactive lane. An expired
// session is gone for every caller. Every call may answer the store's faults, kStoreUnavailable and
// kDataLoss; nothing has changed then.
class SessionRegistry {
 public:
  // All outlive the registry. `released` hears the last record of every session that has ended
  // here, in the thread that ended it.
  SessionRegistry(const Limits& limits, const runtime::Clock& clock, store::SpecStore& store,
                  std::function<void(const store::SessionRecord&)> released);

  // Opens a session; a ttl of 0 is the default ttl. With an equal spec under the id, answers that
  // session and extends its life. Faults: kInvalidName, kInvalidOption, kAlreadyExists,
  // kLimitExceeded.
  Result<SessionView> Create(const Caller& caller, SessionSpec spec);

  // The session, its life extended; read from the store when it is not in memory or has changed
  // there. kNotFound.
  Result<std::shared_ptr<Session>> Use(const std::string& owner, const std::string& id);
  // The same without asking the store: null when it would have to be asked. Never blocks.
  std::shared_ptr<Session> Peek(const std::string& owner, const std::string& id);

  // What it holds, its life not extended. kNotFound.
  Result<SessionView> View(const std::string& owner, const std::string& id);

  // A page of at most `size` sessions (0: the default) after `token`. kInvalidOption.
  Result<SessionPage> List(const std::string& owner, std::size_t size, const std::string& token);

  // Ends the session. kNotFound.
  Status Delete(const std::string& owner, const std::string& id);

  // Changes the record and stores it before it answers. `edit` gets a copy and says whether it has
  // changed it; it is called again when another process was faster. Returns the record in force.
  // Faults: kNotFound when the session has ended, and those of `edit`.
  using Edit = std::function<Result<bool>(store::SessionRecord&)>;
  Result<Session::Record> Change(Session& session, const Edit& edit);

  // Whether a session in memory has a mesh with this blob.
  bool InUse(const std::string& owner, const std::string& blob) const;
  std::size_t in_memory() const;

  // Stores expiries that have moved and ends what has expired. To be called every second or so.
  // Answers the store's fault if it failed; the next sweep tries again.
  Status Sweep();

 private:
  using Sessions = std::map<store::SessionKey, std::shared_ptr<Session>>;
  using Found = std::shared_ptr<Session>;

  Found InMemory(const store::SessionKey& key) const;
  Result<Found> Find(const store::SessionKey& key);
  // Takes it out of memory and ends it; harmless when it is not there any more.
  void Drop(const Found& session);
  // Drops a session that has expired here, and removes it from the store unless another process has
  // extended it.
  Status Expire(const Found& session);
  Status ExpireAll();
  Status CheckRoom(const Caller& caller);

  const Limits& limits_;
  const runtime::Clock& clock_;
  store::SpecStore& store_;
  const std::function<void(const store::SessionRecord&)> released_;
  // Held from reading a record or a count until the change that rests on it is stored. Before
  // mutex_. Recursive: finding a session may end an expired one on the way.
  std::recursive_mutex writes_;
  mutable std::mutex mutex_;
  Sessions sessions_;  // guarded by mutex_
};

}  // namespace arap::app
