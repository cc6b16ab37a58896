#include "server/store/sqlite/session_database.h"

#include <cerrno>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/files.h"
#include "core/base/try.h"
#include "server/store/sqlite/session_rows.h"

namespace arap::store {
namespace {

constexpr const char* kDatabaseName = "/sessions.db";

// "new" is being written; "ready" is complete and takes the place of the damaged one.
std::string NewPath(const std::string& directory) { return directory + kDatabaseName + ".new"; }
std::string ReadyPath(const std::string& directory) { return directory + kDatabaseName + ".ready"; }

bool Exists(const std::string& path) {
  struct stat info {};
  return lstat(path.c_str(), &info) == 0;
}

int RemoveFile(const std::string& path) {
  return unlink(path.c_str()) == 0 || errno == ENOENT ? 0 : errno;
}

std::string FreeName(const std::string& directory) {
  for (int i = 1;; ++i) {
    std::string path = directory + kDatabaseName + ".corrupt-" + std::to_string(i);
    if (!Exists(path) && !Exists(path + "-wal")) return path;
  }
}

// What can still be read about one row of a damaged database.
struct Trace {
  SessionKey key;
  bool has_key = false;
  std::int64_t expires = 0;
};
using Traces = std::map<std::int64_t, Trace>;

// Reads the rows in one order as far as it goes. False when it ended with an error.
bool Follow(Sqlite& database, const char* sql, bool has_key, bool has_expiry, Traces& traces) {
  Query query(database, sql);
  while (query.Row()) {
    Trace& trace = traces[query.Int(0)];
    if (has_key) trace.key = {query.Text(1), query.Text(2)};
    trace.has_key = trace.has_key || has_key;
    if (has_expiry) trace.expires = query.Int(3);
  }
  return query.code() == SQLITE_OK;
}

// From both ends of the table and of its indices, so that one bad page hides little.
Traces FindRows(Sqlite& database, bool& complete) {
  Traces traces;
  const bool table = Follow(database, "SELECT number FROM sessions NOT INDEXED ORDER BY number",
                            false, false, traces);
  if (!table) {
    Follow(database, "SELECT number FROM sessions NOT INDEXED ORDER BY number DESC", false, false,
           traces);
  }
#define ARAP_KEYS "SELECT number, owner, id, expires FROM sessions INDEXED BY "
#define ARAP_KEY "SELECT number, owner, id FROM sessions INDEXED BY "
  const bool keys = Follow(database, ARAP_KEY "by_key ORDER BY owner, id", true, false, traces);
  if (!keys) {
    Follow(database, ARAP_KEY "by_key ORDER BY owner DESC, id DESC", true, false, traces);
  }
  const bool expiries =
      Follow(database, ARAP_KEYS "by_expiry ORDER BY expires, owner, id", true, true, traces);
  if (!expiries) {
    Follow(database, ARAP_KEYS "by_expiry ORDER BY expires DESC, owner DESC, id DESC", true, true,
           traces);
  }
#undef ARAP_KEYS
#undef ARAP_KEY
  complete = table || keys || expiries;
  return traces;
}

// The row and the record in it, as far as they can be read.
Result<SessionRecord> ReadOld(Sqlite& old, std::int64_t number, SessionRow& row) {
  Query query(old, "SELECT " ARAP_SESSION_COLUMNS " FROM sessions NOT INDEXED WHERE number = ?");
  if (!query.Bind(number).Row()) return Fail(LostRecord({}));
  row = ReadRow(query);
  return RecordOf(row);
}

// A row without its record: the session is known to be damaged.
SessionRow Remains(const Trace& trace) { return {trace.key, 0, trace.expires, "", ""}; }

SqliteCode CarryOver(Sqlite& old, Sqlite& fresh, Recovery& recovery) {
  Transaction transaction(fresh);
  if (transaction.code() != SQLITE_OK) return transaction.code();
  std::set<SessionKey> carried;
  std::map<SessionKey, SessionRow> remains;
  for (const auto& [number, trace] : FindRows(old, recovery.complete)) {
    SessionRow row;
    const auto record = ReadOld(old, number, row);
    if (!record) {
      ++recovery.lost;
      if (trace.has_key) remains.emplace(trace.key, Remains(trace));
    } else if (carried.insert(row.key).second) {
      if (const SqliteCode code = WriteRow(fresh, row, *record, 0); code != SQLITE_OK) return code;
      ++recovery.saved;
    }
  }
  for (const auto& [key, row] : remains) {
    if (carried.contains(key)) continue;
    if (const SqliteCode code = WriteRow(fresh, row, {}, 0); code != SQLITE_OK) return code;
  }
  return transaction.Commit();
}

SqliteCode Build(const std::string& directory, Recovery& recovery) {
  auto fresh = Sqlite::Open(NewPath(directory), Sqlite::Missing::kCreate);
  if (!fresh) return fresh.error();
  // One file, so that it can be renamed as a whole.
  SqliteCode code = fresh->Run("PRAGMA journal_mode = DELETE; PRAGMA synchronous = FULL");
  if (code == SQLITE_OK) code = CreateTables(*fresh);
  if (code != SQLITE_OK) return code;
  auto old = Sqlite::Open(directory + kDatabaseName, Sqlite::Missing::kRefuse);
  if (!old) return SQLITE_OK;
  // The damaged one stays as it is, with its log.
  sqlite3_db_config(old->get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  old->Run("PRAGMA locking_mode = EXCLUSIVE");
  return CarryOver(*old, *fresh, recovery);
}

// Ends what an interrupted RecoverDatabase began; harmless when there is nothing.
Status FinishRecovery(const std::string& directory) {
  const std::string path = directory + kDatabaseName;
  int error = RemoveFile(NewPath(directory));
  if (error == 0) error = RemoveFile(NewPath(directory) + "-journal");
  if (error == 0 && Exists(ReadyPath(directory))) {
    // The log goes with the damaged database: SQLite would apply it to the new one.
    const std::string aside = FreeName(directory);
    if (Exists(path)) error = Rename(path, aside);
    if (error == 0 && Exists(path + "-wal")) error = Rename(path + "-wal", aside + "-wal");
    if (error == 0) error = RemoveFile(path + "-shm");
    if (error == 0) error = SyncDirectory(directory);
    if (error == 0) error = Rename(ReadyPath(directory), path);
    if (error == 0) error = SyncDirectory(directory);
  }
  if (error != 0) return Fail(UnavailableErrno(error));
  return {};
}

// Builds a new sessions.db in `directory` from what can be read of the one there, which is kept as
// sessions.db.corrupt-N. Nobody may have it open. Interrupted at any point, nothing is lost: call
// FinishRecovery and begin again. kStoreUnavailable when a new one cannot be written.
Result<Recovery> RecoverDatabase(const std::string& directory) {
  Recovery recovery;
  if (const SqliteCode code = Build(directory, recovery); code != SQLITE_OK) {
    RemoveFile(NewPath(directory));
    return Fail(SqliteFault(code));
  }
  int error = Rename(NewPath(directory), ReadyPath(directory));
  if (error == 0) error = SyncDirectory(directory);
  if (error != 0) return Fail(UnavailableErrno(error));
  recovery.kept_as = FreeName(directory);
  CHECK_OK(FinishRecovery(directory));
  return recovery;
}

// Run before the version is read: a database that a later server wrote must stay as it is.
constexpr const char* kLocking = "PRAGMA locking_mode = EXCLUSIVE; PRAGMA cell_size_check = ON";
// The log is cut back once its pages are in the database, so that it does not keep a disk full.
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
  if (version == 0 && trust == Trust::kCheck) return CreateTables(database);
  if (version == 1) code = UpgradeTables(database);
  return code == SQLITE_OK ? CheckTables(database) : code;
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
  CHECK_OK(FinishRecovery(directory));
  Attempt attempt = Try(directory, trust, opened.database);
  if (IsDamage(attempt.code)) {
    TRY(auto recovery, RecoverDatabase(directory));
    opened.recovery = std::move(recovery);
    attempt = Try(directory, Trust::kCheck, opened.database);
  }
  if (attempt.version > kSchemaVersion) {
    return Fail(Unavailable("its database was written by a later version"));
  }
  if (attempt.code != SQLITE_OK) return Fail(SqliteFault(attempt.code));
  return opened;
}

Fault SqliteFault(SqliteCode code) {
  switch (code) {
    case SQLITE_FULL:
      return Unavailable("the disk is full");
    case SQLITE_READONLY:
      return Unavailable("its directory is read-only");
    case SQLITE_CANTOPEN:
      return Unavailable("its database cannot be opened");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return Unavailable("its database is in use by somebody else");
    case SQLITE_IOERR:
      return Unavailable("the disk refuses to read or write");
    case SQLITE_NOMEM:
      return Unavailable("there is no memory left");
    default:
      if (IsDamage(code)) return Unavailable("its database is damaged");
      return Unavailable(sqlite3_errstr(code));
  }
}

bool IsDamage(SqliteCode code) {
  // SQLITE_ERROR: a table or a column is missing, for our statements are right.
  return code == SQLITE_CORRUPT || code == SQLITE_NOTADB || code == SQLITE_FORMAT ||
         code == SQLITE_ERROR;
}

bool IsBroken(SqliteCode code) {
  return IsDamage(code) || code == SQLITE_IOERR || code == SQLITE_READONLY ||
         code == SQLITE_CANTOPEN || code == SQLITE_PROTOCOL || code == SQLITE_INTERNAL;
}

}  // namespace arap::store
