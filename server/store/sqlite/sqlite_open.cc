#include "server/store/sqlite/sqlite_open.h"

#include <utility>

#include "server/store/sqlite/sqlite_fault.h"
#include "server/store/sqlite/sqlite_records.h"
#include "server/store/sqlite/sqlite_recovery.h"
#include "server/store/store_fault.h"

namespace arap::store {
namespace {

// The version comes first: nothing is done to a database that a later server wrote.
constexpr const char* kLocking = "PRAGMA locking_mode = EXCLUSIVE; PRAGMA cell_size_check = ON";
// The log is cut back when it has been written home; a full disk should not stay full for it.
constexpr const char* kSetup =
    "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA journal_size_limit = 8388608;"
    "PRAGMA trusted_schema = OFF";

SqliteResult<std::int64_t> ReadVersion(Sqlite& database) {
  Query query(database, "PRAGMA user_version");
  if (!query.Row()) return tl::unexpected(query.code() == SQLITE_OK ? SQLITE_ERROR : query.code());
  return query.Int(0);
}

SqliteCode CheckPages(Sqlite& database) {
  Query query(database, "PRAGMA quick_check(1)");
  if (!query.Row()) return query.code() == SQLITE_OK ? SQLITE_ERROR : query.code();
  return query.Text(0) == "ok" ? SQLITE_OK : SQLITE_CORRUPT;
}

SqliteCode Prepare(Sqlite& database, std::int64_t version, Trust trust) {
  SqliteCode code = database.Run(kSetup);
  if (code == SQLITE_OK && trust == Trust::kCheck) code = CheckPages(database);
  if (code != SQLITE_OK) return code;
  return version == 0 && trust == Trust::kCheck ? CreateTables(database) : CheckTables(database);
}

struct Attempt {
  SqliteCode code = SQLITE_OK;
  std::int64_t version = 0;
};

Attempt Try(const std::string& directory, Trust trust, Sqlite& database) {
  auto opened =
      Sqlite::Open(directory + kDatabaseName,
                   trust == Trust::kCheck ? Sqlite::Missing::kCreate : Sqlite::Missing::kRefuse);
  if (!opened) return {opened.error(), 0};
  if (const SqliteCode code = opened->Run(kLocking); code != SQLITE_OK) return {code, 0};
  const auto version = ReadVersion(*opened);
  if (!version) return {version.error(), 0};
  if (*version > kSchemaVersion) return {SQLITE_OK, *version};
  const SqliteCode code = Prepare(*opened, *version, trust);
  if (code == SQLITE_OK) database = *std::move(opened);
  return {code, *version};
}

}  // namespace

Result<OpenedDatabase> OpenDatabase(const std::string& directory, Trust trust) {
  OpenedDatabase opened;
  if (auto finished = FinishRecovery(directory); !finished) return Fail(finished.error());
  Attempt attempt = Try(directory, trust, opened.database);
  if (IsDamage(attempt.code)) {
    auto recovery = RecoverDatabase(directory);
    if (!recovery) return Fail(recovery.error());
    opened.recovery = *std::move(recovery);
    attempt = Try(directory, Trust::kCheck, opened.database);
  }
  if (attempt.version > kSchemaVersion) {
    return Fail(Unavailable("its database was written by a later version"));
  }
  if (attempt.code != SQLITE_OK) return Fail(SqliteFault(attempt.code));
  return opened;
}

}  // namespace arap::store
