// SessionRegistry: the sessions of this server by id.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/app/limits.h"
#include "server/app/session.h"
#include "server/runtime/clock.h"

namespace arap::app {

// Sessions in the order of their ids.
struct SessionPage {
  std::vector<SessionView> sessions;
  std::string next_token;  // empty at the end
};

// Thread-safe. An expired session is gone for every caller; its memory goes when somebody asks for
// it, and with every Create and List.
class SessionRegistry {
 public:
  // `limits` and `clock` outlive the registry.
  SessionRegistry(const Limits& limits, const runtime::Clock& clock)
      : limits_(limits), clock_(clock) {}

  // Opens a session; a ttl of 0 is the default ttl. With an equal spec under the id, answers that
  // session and extends its life. Faults: kInvalidName, kInvalidOption, kAlreadyExists,
  // kLimitExceeded.
  Result<SessionView> Create(SessionSpec spec);

  // The session, its life extended. kNotFound.
  Result<std::shared_ptr<Session>> Use(const std::string& id);

  // What it holds, its life not extended. kNotFound.
  Result<SessionView> View(const std::string& id);

  // A page of at most `size` sessions (0: the default) after `token`. kInvalidOption.
  Result<SessionPage> List(std::size_t size, const std::string& token);

  // Ends the session. kNotFound.
  Status Delete(const std::string& id);

 private:
  using Sessions = std::map<std::string, std::shared_ptr<Session>>;

  Result<std::shared_ptr<Session>> Find(const std::string& id);
  // Takes the expired sessions out; the caller ends them without the lock.
  std::vector<std::shared_ptr<Session>> TakeExpiredLocked();

  const Limits& limits_;
  const runtime::Clock& clock_;
  std::mutex mutex_;
  Sessions sessions_;  // guarded by mutex_
};

}  // namespace arap::app
