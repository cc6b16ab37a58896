// BusyClient: makes, edits and removes things at random and keeps the ledger of what it was told.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "tests/support/random.h"
#include "tests/system/fault/client.h"
#include "tests/system/fault/ledger.h"

namespace arap::fault {

// Owns the sessions whose ids begin with its name; for one thread at a time. Lives longer than any
// server: Work runs against one, Check against the next.
class BusyClient {
 public:
  BusyClient(std::string name, std::uint64_t seed) : name_(std::move(name)), random_(seed) {}

  // Calls until the server is gone. `acknowledged` counts the calls that were answered. An answer
  // that should not be is a failure of the test.
  void Work(const std::string& address, std::atomic<std::size_t>& acknowledged);

  // Everything that was acknowledged is there and answers the same bytes; nothing else is, except
  // what the one call without an answer may have done.
  void Check(FaultClient& client);

  const std::map<std::string, SessionEntry>& sessions() const { return sessions_; }

 private:
  // Does one call: its session as it is afterwards, if the server does it.
  bool Step(FaultClient& client);
  // Notes what the call is about to do, makes it, and settles the ledger if it was answered.
  bool Try(const std::string& session, const MaybeSession& after,
           const std::function<grpc::Status()>& call);

  bool Create(FaultClient& client);
  bool Register(FaultClient& client, const std::string& session);
  bool Compile(FaultClient& client, const std::string& session);
  bool Edit(FaultClient& client, const std::string& session, const std::string& set);
  bool Remove(FaultClient& client, const std::string& session);
  bool Ask(FaultClient& client, const std::string& session, const std::string& set);
  bool Drag(FaultClient& client, const std::string& session, const std::string& set);
  MaybeSession Known(const std::string& session) const;
  std::string NewId(const char* kind);

  const std::string name_;
  testing::Random random_;
  std::uint64_t next_id_ = 0;
  std::map<std::string, SessionEntry> sessions_;

  // The call that was not answered.
  std::string open_session_;  // empty: none
  MaybeSession open_after_;
};

}  // namespace arap::fault
