#include "server/store/sqlite/sqlite.h"

#include <fcntl.h>
#include <sys/stat.h>

#include "core/base/files.h"

namespace arap::store {
namespace {

SqliteCode Primary(int code) { return code & 0xff; }

// Earlier versions left the mode to the umask. Where it cannot be changed it stays as it is.
void KeepOthersOut(const std::string& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0 || (info.st_mode & (S_IRWXG | S_IRWXO)) == 0) return;
  [[maybe_unused]] const int done = chmod(path.c_str(), info.st_mode & S_IRWXU);
}

}  // namespace

SqliteResult<Sqlite> Sqlite::Open(const std::string& path, Missing missing) {
  int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX;
  if (missing == Missing::kCreate) {
    flags |= SQLITE_OPEN_CREATE;
    // SQLite would make it for everybody to read. Its log takes the mode of the database.
    const File made(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  }
  for (const char* part : {"", "-wal", "-shm"}) KeepOthersOut(path + part);
  sqlite3* connection = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &connection, flags, nullptr);
  Sqlite database;
  database.connection_.reset(connection);  // there is one even after most failures
  if (code != SQLITE_OK) return tl::unexpected(Primary(code));
  return database;
}

SqliteCode Sqlite::Run(const std::string& sql) {
  return Primary(sqlite3_exec(get(), sql.c_str(), nullptr, nullptr, nullptr));
}

sqlite3_stmt* Sqlite::Prepared(const char* sql) {
  auto& statement = statements_[sql];
  if (statement == nullptr) {
    sqlite3_stmt* made = nullptr;
    sqlite3_prepare_v3(get(), sql, -1, SQLITE_PREPARE_PERSISTENT, &made, nullptr);
    statement.reset(made);
  }
  return statement.get();
}

Query::Query(Sqlite& database, const char* sql) : statement_(database.Prepared(sql)) {
  if (statement_ == nullptr) {
    code_ = Primary(database.last_code());
    if (code_ == SQLITE_OK) code_ = SQLITE_ERROR;
  }
}

Query::~Query() {
  if (statement_ == nullptr) return;
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

Query& Query::Bind(std::int64_t number) {
  if (code_ == SQLITE_OK) code_ = Primary(sqlite3_bind_int64(statement_, ++bound_, number));
  return *this;
}

Query& Query::Bind(std::string_view text) {
  if (code_ != SQLITE_OK) return *this;
  // A null pointer would bind NULL.
  const char* data = text.empty() ? "" : text.data();
  code_ = Primary(
      sqlite3_bind_text64(statement_, ++bound_, data, text.size(), SQLITE_STATIC, SQLITE_UTF8));
  return *this;
}

bool Query::Row() {
  if (code_ != SQLITE_OK) return false;
  const int step = sqlite3_step(statement_);
  if (step == SQLITE_ROW) return true;
  if (step != SQLITE_DONE) code_ = Primary(step);
  return false;
}

SqliteCode Query::Run() {
  while (Row()) {
  }
  return code_;
}

std::int64_t Query::Int(int column) const { return sqlite3_column_int64(statement_, column); }

std::string Query::Text(int column) const {
  const void* data = sqlite3_column_blob(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  if (data == nullptr) return {};
  return {static_cast<const char*>(data), static_cast<std::size_t>(size)};
}

Transaction::Transaction(Sqlite& database)
    : database_(database), code_(database.Run("BEGIN IMMEDIATE")) {}

Transaction::~Transaction() {
  // Some errors have rolled back by themselves.
  if (sqlite3_get_autocommit(database_.get()) == 0) database_.Run("ROLLBACK");
}

SqliteCode Transaction::Commit() { return database_.Run("COMMIT"); }

}  // namespace arap::store
