// SqliteSpecStore: records in a database file, for one server.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/files.h"
#include "core/base/mutex.h"
#include "server/store/sqlite/session_rows.h"
#include "server/store/sqlite/sqlite.h"
#include "server/store/store.h"

namespace arap::store {

// One connection behind a mutex: calls wait for each other, and every change waits for the disk.
// What was acknowledged survives the end of the process and of the machine.
//
// A database that turns out to be damaged, now or at opening, is recovered within the call that
// noticed: it is kept as sessions.db.corrupt-N, all readable records go into a new one, and those
// that are lost answer kDataLoss. After any other fault the next call tries again.
class SqliteSpecStore final : public SpecStore {
 public:
  // Hears of recoveries after opening; called within a call, so it must not call the store.
  using Listener = std::function<void(const Recovery&)>;

  // Opens or creates the database in `directory`, which has to be there, and keeps others out of
  // the directory. kStoreUnavailable, naming the directory, when that cannot be.
  static Result<std::unique_ptr<SqliteSpecStore>> Open(const std::string& directory,
                                                       Listener listener = {});

  // What opening had to repair.
  const std::optional<Recovery>& recovery() const { return recovery_; }

  Result<std::optional<SessionRecord>> Load(const SessionKey& key) override;
  Result<std::optional<RecordVersion>> Version(const SessionKey& key) override;
  Result<bool> Put(const SessionRecord& record) override;
  Result<bool> Extend(const SessionKey& key, const std::string& incarnation,
                      runtime::Clock::Wall expires) override;
  Result<bool> Remove(const SessionKey& key) override;
  Result<bool> RemoveAsOf(const SessionKey& key, runtime::Clock::Wall expires) override;
  Result<std::vector<SessionRecord>> List(const std::string& owner, const std::string& after,
                                          std::size_t limit) override;
  Result<std::vector<std::string>> Owners() override;
  Result<Usage> UsageOf(const std::string& owner) override;
  Result<Usage> UsageUnder(const std::string& owner) override;
  Result<std::size_t> Count() override;
  Result<std::vector<SessionKey>> RemoveExpired(runtime::Clock::Wall now,
                                                std::size_t limit) override;
  Status Shift(std::chrono::milliseconds by) override;
  Result<std::set<std::string>> ReferencedBlobs() override;
  Result<std::optional<runtime::Clock::Wall>> Time() override { return std::nullopt; }
  Result<StoreFacts> Facts() override { return StoreFacts{id_, {}}; }
  bool shared() const override { return false; }
  Status Probe() override;

 private:
  SqliteSpecStore() = default;

  // Runs `body`, a function from Sqlite& to SqliteResult<T>, on a connection that is open; once
  // more on a recovered one.
  template <class T, class Body>
  Result<T> With(const Body& body);
  // Of the owners from `first` on that come before `end`.
  Result<Usage> SumOfOwners(std::string_view first, std::string_view end);
  Status EnsureOpen() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool IsInPlace() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  std::string directory_;
  std::string id_;
  Listener listener_;
  std::optional<Recovery> recovery_;
  FileLock lock_;
  Mutex mutex_;
  std::optional<Sqlite> database_ ABSL_GUARDED_BY(mutex_);  // nothing after a fault
  bool damaged_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace arap::store
