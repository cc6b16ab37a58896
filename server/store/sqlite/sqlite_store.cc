#include "server/store/sqlite/sqlite_store.h"

#include <cerrno>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>

#include "core/base/files.h"
#include "core/base/try.h"
#include "core/token/digest.h"
#include "server/store/record_format.h"
#include "server/store/sqlite/session_database.h"
#include "server/store/sqlite/sqlite.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

Fault NamingDirectory(Fault fault, const std::string& directory) {
  fault.message = fmt::format("{}: {}", directory, fault.message);
  return fault.Detail("directory", directory);
}

// In a file of its own, so that it outlives a damaged database. Made when there is none.
Result<std::string> IdOf(const std::string& directory) {
  const std::string path = directory + "/store-id";
  std::string id;
  int error = ReadWhole(path, id);
  if (error == ENOENT) {
    TRY(id, RandomHex(32));
    error = ReplaceFile(path, id);
  }
  if (error != 0) return Fail(NamingDirectory(UnavailableErrno(error), directory));
  return id;
}

// The value of a query that has run, or its error.
template <class T>
SqliteResult<T> Finished(const Query& query, T value) {
  if (query.code() != SQLITE_OK) return tl::unexpected(query.code());
  return value;
}

struct Place {
  std::int64_t number = 0;  // 0: there is no such row
  RecordVersion version;
};

SqliteResult<Place> Find(Sqlite& database, const SessionKey& key) {
  Query query(database,
              "SELECT number, revision, incarnation FROM sessions WHERE owner = ? AND id = ?");
  Place place;
  if (query.Bind(key.owner).Bind(key.id).Row()) {
    place = {query.Int(0), {query.Text(2), static_cast<std::uint64_t>(query.Int(1))}};
  }
  return Finished(query, place);
}

}  // namespace

Result<std::unique_ptr<SqliteSpecStore>> SqliteSpecStore::Open(const std::string& directory,
                                                               Listener listener) {
  std::unique_ptr<SqliteSpecStore> store(new SqliteSpecStore);
  const int error =
      FileLock::Take(directory + "/lock", FileLock::Kind::kExclusive, false, store->lock_);
  if (error == EWOULDBLOCK) {
    return Fail(NamingDirectory(Unavailable("another server uses the directory"), directory));
  }
  if (error != 0) return Fail(NamingDirectory(UnavailableErrno(error), directory));
  TRY(store->id_, IdOf(directory));
  auto opened = OpenDatabase(directory, Trust::kCheck);
  if (!opened) return Fail(NamingDirectory(std::move(opened).error(), directory));
  store->directory_ = directory;
  store->listener_ = std::move(listener);
  store->recovery_ = std::move(opened->recovery);
  const MutexLock lock(&store->mutex_);
  store->database_ = std::move(opened->database);
  return store;
}

// False when the file was moved or removed: what is written to it now would end with this process.
bool SqliteSpecStore::IsInPlace() const {
  int moved = 0;
  sqlite3_file_control(database_->get(), "main", SQLITE_FCNTL_HAS_MOVED, &moved);
  return moved == 0;
}

Status SqliteSpecStore::EnsureOpen() {
  if (database_ && !IsInPlace()) database_.reset();
  if (database_) return {};
  TRY(auto opened, OpenDatabase(directory_, damaged_ ? Trust::kCheck : Trust::kAsItWas));
  database_ = std::move(opened.database);
  damaged_ = false;
  if (opened.recovery && listener_) listener_(*opened.recovery);
  return {};
}

template <class T, class Body>
Result<T> SqliteSpecStore::With(const Body& body) {
  const MutexLock lock(&mutex_);
  for (bool again = true;; again = false) {
    CHECK_OK(EnsureOpen());
    SqliteResult<T> result = body(*database_);
    if (result) return *std::move(result);
    if (IsBroken(result.error())) database_.reset();
    damaged_ = damaged_ || IsDamage(result.error());
    if (!again || !damaged_) return Fail(SqliteFault(result.error()));
  }
}

Result<std::optional<SessionRecord>> SqliteSpecStore::Load(const SessionKey& key) {
  auto row = With<std::optional<SessionRow>>(
      [&](Sqlite& database) -> SqliteResult<std::optional<SessionRow>> {
        Query query(database,
                    "SELECT " ARAP_SESSION_COLUMNS " FROM sessions WHERE owner = ? AND id = ?");
        std::optional<SessionRow> found;
        if (query.Bind(key.owner).Bind(key.id).Row()) found = ReadRow(query);
        return Finished(query, std::move(found));
      });
  if (!row) return Fail(row.error());
  if (!*row) return std::nullopt;
  return RecordOf(**row);
}

Result<std::optional<RecordVersion>> SqliteSpecStore::Version(const SessionKey& key) {
  auto place = With<Place>([&](Sqlite& database) { return Find(database, key); });
  if (!place) return Fail(place.error());
  if (place->number == 0) return std::nullopt;
  return place->version;
}

Result<bool> SqliteSpecStore::Put(const SessionRecord& record) {
  TRY(const auto row, RowOf(record));
  return With<bool>([&](Sqlite& database) -> SqliteResult<bool> {
    Transaction transaction(database);
    if (transaction.code() != SQLITE_OK) return tl::unexpected(transaction.code());
    const auto place = Find(database, record.key);
    if (!place) return tl::unexpected(place.error());
    // The row of a damaged record has revision 0: its key is taken.
    RecordVersion after = place->version;
    ++after.revision;
    const bool fits = place->number == 0 ? record.revision == 1
                                         : after.revision != 1 && after == VersionOf(record);
    if (!fits) return false;
    SqliteCode code = WriteRow(database, row, record, place->number);
    if (code == SQLITE_OK) code = transaction.Commit();
    if (code != SQLITE_OK) return tl::unexpected(code);
    return true;
  });
}

Result<bool> SqliteSpecStore::Extend(const SessionKey& key, const std::string& incarnation,
                                     runtime::Clock::Wall expires) {
  return With<bool>([&](Sqlite& database) {
    Query query(database,
                "UPDATE sessions SET expires = ? WHERE owner = ? AND id = ? AND incarnation = ?");
    query.Bind(ToMillis(expires)).Bind(key.owner).Bind(key.id).Bind(incarnation).Run();
    return Finished(query, sqlite3_changes(database.get()) > 0);
  });
}

Result<bool> SqliteSpecStore::Remove(const SessionKey& key) {
  return With<bool>([&](Sqlite& database) {
    Query query(database, "DELETE FROM sessions WHERE owner = ? AND id = ?");
    query.Bind(key.owner).Bind(key.id).Run();
    return Finished(query, sqlite3_changes(database.get()) > 0);
  });
}

Result<bool> SqliteSpecStore::RemoveAsOf(const SessionKey& key, runtime::Clock::Wall expires) {
  return With<bool>([&](Sqlite& database) {
    Query query(database, "DELETE FROM sessions WHERE owner = ? AND id = ? AND expires = ?");
    query.Bind(key.owner).Bind(key.id).Bind(ToMillis(expires)).Run();
    return Finished(query, sqlite3_changes(database.get()) > 0);
  });
}

Result<std::vector<SessionRecord>> SqliteSpecStore::List(const std::string& owner,
                                                         const std::string& after,
                                                         std::size_t limit) {
  std::vector<SessionRecord> records;
  std::string last = after;
  for (bool more = true; more && records.size() < limit;) {
    const std::size_t want = limit - records.size();
    auto rows = With<std::vector<SessionRow>>([&](Sqlite& database) {
      Query query(database, "SELECT " ARAP_SESSION_COLUMNS
                            " FROM sessions WHERE owner = ? AND id > ? ORDER BY id LIMIT ?");
      query.Bind(owner).Bind(last).Bind(static_cast<std::int64_t>(want));
      std::vector<SessionRow> found;
      while (query.Row()) found.push_back(ReadRow(query));
      return Finished(query, std::move(found));
    });
    if (!rows) return Fail(rows.error());
    for (const SessionRow& row : *rows) {
      if (auto record = RecordOf(row)) records.push_back(*std::move(record));
    }
    more = rows->size() == want;
    if (more) last = rows->back().key.id;
  }
  return records;
}

Result<std::vector<std::string>> SqliteSpecStore::Owners() {
  return With<std::vector<std::string>>([](Sqlite& database) {
    Query query(database, "SELECT owner FROM owners ORDER BY owner");
    std::vector<std::string> owners;
    while (query.Row()) owners.push_back(query.Text(0));
    return Finished(query, std::move(owners));
  });
}

Result<Usage> SqliteSpecStore::SumOfOwners(std::string_view first, std::string_view end) {
  return With<Usage>([&](Sqlite& database) {
    Query query(database,
                "SELECT coalesce(sum(sessions), 0), coalesce(sum(meshes), 0), "
                "coalesce(sum(handle_sets), 0), coalesce(sum(bytes), 0) "
                "FROM owners WHERE owner >= ? AND owner < ?");
    Usage usage;
    if (query.Bind(first).Bind(end).Row()) {
      usage.sessions = static_cast<std::size_t>(query.Int(0));
      usage.meshes = static_cast<std::size_t>(query.Int(1));
      usage.handle_sets = static_cast<std::size_t>(query.Int(2));
      usage.bytes = static_cast<std::size_t>(query.Int(3));
    }
    return Finished(query, usage);
  });
}

Result<Usage> SqliteSpecStore::UsageOf(const std::string& owner) {
  return SumOfOwners(owner, owner + '\x01');  // no owner has such a character
}

Result<Usage> SqliteSpecStore::UsageUnder(const std::string& owner) {
  TRY(Usage usage, UsageOf(owner));
  // All names that begin with "OWNER/": the digit 0 comes next after the slash.
  TRY(const Usage users, SumOfOwners(owner + '/', owner + '0'));
  usage += users;
  return usage;
}

Result<std::size_t> SqliteSpecStore::Count() {
  return With<std::size_t>([](Sqlite& database) {
    Query query(database, "SELECT coalesce(sum(sessions), 0) FROM owners");
    const std::size_t count = query.Row() ? static_cast<std::size_t>(query.Int(0)) : 0;
    return Finished(query, count);
  });
}

Result<std::vector<SessionKey>> SqliteSpecStore::RemoveExpired(runtime::Clock::Wall now,
                                                               std::size_t limit) {
  // Expiries were rounded up; so this is rounded down.
  const std::int64_t millis =
      std::chrono::floor<std::chrono::milliseconds>(now.time_since_epoch()).count();
  using Keys = std::vector<SessionKey>;
  return With<Keys>([&](Sqlite& database) -> SqliteResult<Keys> {
    Transaction transaction(database);
    if (transaction.code() != SQLITE_OK) return tl::unexpected(transaction.code());
    Keys removed;
    std::vector<std::int64_t> numbers;
    Query query(database,
                "SELECT number, owner, id FROM sessions WHERE expires <= ? ORDER BY expires "
                "LIMIT ?");
    query.Bind(millis).Bind(static_cast<std::int64_t>(limit));
    while (query.Row()) {
      numbers.push_back(query.Int(0));
      removed.push_back({query.Text(1), query.Text(2)});
    }
    if (query.code() != SQLITE_OK) return tl::unexpected(query.code());
    if (numbers.empty()) return removed;
    for (const std::int64_t number : numbers) {
      Query remove(database, "DELETE FROM sessions WHERE number = ?");
      if (remove.Bind(number).Run() != SQLITE_OK) return tl::unexpected(remove.code());
    }
    if (const SqliteCode code = transaction.Commit(); code != SQLITE_OK) {
      return tl::unexpected(code);
    }
    return removed;
  });
}

Status SqliteSpecStore::Shift(std::chrono::milliseconds by) {
  CHECK_OK(With<bool>([&](Sqlite& database) {
    Query query(database, "UPDATE sessions SET expires = expires + ?");
    query.Bind(std::int64_t{by.count()}).Run();
    return Finished(query, true);
  }));
  return {};
}

Result<std::set<std::string>> SqliteSpecStore::ReferencedBlobs() {
  using Names = std::set<std::string>;
  return With<Names>([](Sqlite& database) {
    Query query(database, "SELECT DISTINCT blob FROM blobs");
    Names blobs;
    while (query.Row()) blobs.insert(query.Text(0));
    return Finished(query, std::move(blobs));
  });
}

Status SqliteSpecStore::Probe() {
  auto done = With<bool>([](Sqlite& database) {
    Query query(database, "SELECT 1 FROM owners LIMIT 1");
    query.Run();
    return Finished(query, true);
  });
  if (!done) return Fail(done.error());
  return {};
}

}  // namespace arap::store
