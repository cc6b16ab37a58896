#include "server/store/sqlite/session_rows.h"

#include <set>

#include "core/base/try.h"
#include "core/token/digest.h"
#include "server/store/record_format.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

constexpr const char* kTables = R"sql(
CREATE TABLE sessions (
  number      INTEGER PRIMARY KEY,
  owner       TEXT NOT NULL,
  id          TEXT NOT NULL,
  revision    INTEGER NOT NULL,
  expires     INTEGER NOT NULL,
  meshes      INTEGER NOT NULL,
  handle_sets INTEGER NOT NULL,
  sum         TEXT NOT NULL,
  record      TEXT NOT NULL,
  incarnation TEXT NOT NULL DEFAULT '',
  bytes       INTEGER NOT NULL DEFAULT 0
);
CREATE UNIQUE INDEX by_key ON sessions (owner, id);
CREATE INDEX by_expiry ON sessions (expires, owner, id);
CREATE TABLE blobs (
  session INTEGER NOT NULL,
  blob    TEXT NOT NULL,
  PRIMARY KEY (session, blob)
) WITHOUT ROWID;
CREATE TABLE owners (
  owner       TEXT NOT NULL PRIMARY KEY,
  sessions    INTEGER NOT NULL,
  meshes      INTEGER NOT NULL,
  handle_sets INTEGER NOT NULL,
  bytes       INTEGER NOT NULL DEFAULT 0
) WITHOUT ROWID;
)sql";

constexpr const char* kTriggers = R"sql(
CREATE TRIGGER session_added AFTER INSERT ON sessions BEGIN
  INSERT INTO owners VALUES (new.owner, 1, new.meshes, new.handle_sets, new.bytes)
    ON CONFLICT (owner) DO UPDATE SET sessions = sessions + 1,
      meshes = meshes + excluded.meshes, handle_sets = handle_sets + excluded.handle_sets,
      bytes = bytes + excluded.bytes;
END;
CREATE TRIGGER session_changed AFTER UPDATE OF meshes, handle_sets, bytes ON sessions BEGIN
  UPDATE owners SET meshes = meshes + new.meshes - old.meshes,
      handle_sets = handle_sets + new.handle_sets - old.handle_sets,
      bytes = bytes + new.bytes - old.bytes
    WHERE owner = new.owner;
END;
CREATE TRIGGER session_removed AFTER DELETE ON sessions BEGIN
  DELETE FROM blobs WHERE session = old.number;
  UPDATE owners SET sessions = sessions - 1, meshes = meshes - old.meshes,
      handle_sets = handle_sets - old.handle_sets, bytes = bytes - old.bytes
    WHERE owner = old.owner;
  DELETE FROM owners WHERE owner = old.owner AND sessions = 0;
END;
PRAGMA user_version = 2;
)sql";

// What is known of the bytes of the sessions of version 1 is the size of their records.
constexpr const char* kFrom1To2 = R"sql(
DROP TRIGGER session_added;
DROP TRIGGER session_changed;
DROP TRIGGER session_removed;
ALTER TABLE sessions ADD COLUMN incarnation TEXT NOT NULL DEFAULT '';
ALTER TABLE sessions ADD COLUMN bytes INTEGER NOT NULL DEFAULT 0;
ALTER TABLE owners ADD COLUMN bytes INTEGER NOT NULL DEFAULT 0;
UPDATE sessions SET bytes = length(CAST(record AS BLOB));
UPDATE owners SET bytes = (SELECT sum(bytes) FROM sessions WHERE sessions.owner = owners.owner);
)sql";

SqliteCode RunInOne(Sqlite& database, const std::string& sql) {
  Transaction transaction(database);
  if (transaction.code() != SQLITE_OK) return transaction.code();
  if (const SqliteCode code = database.Run(sql); code != SQLITE_OK) return code;
  return transaction.Commit();
}

}  // namespace

SqliteCode CreateTables(Sqlite& database) {
  return RunInOne(database, std::string(kTables) + kTriggers);
}

SqliteCode UpgradeTables(Sqlite& database) {
  return RunInOne(database, std::string(kFrom1To2) + kTriggers);
}

SqliteCode CheckTables(Sqlite& database) {
  return database.Run("SELECT number, " ARAP_SESSION_COLUMNS
                      ", meshes, handle_sets, incarnation, bytes FROM sessions LIMIT 0;"
                      "SELECT session, blob FROM blobs LIMIT 0;"
                      "SELECT owner, sessions, meshes, handle_sets, bytes FROM owners LIMIT 0");
}

SessionRow ReadRow(const Query& query) {
  return {{query.Text(0), query.Text(1)}, query.Int(2), query.Int(3), query.Text(4), query.Text(5)};
}

Result<SessionRecord> RecordOf(const SessionRow& row) {
  TRY(const auto sum, Sha256Hex(row.text));
  if (sum != row.sum) return Fail(LostRecord(row.key));
  auto record = DecodeRecord(row.text);
  if (!record && record.error().kind == FaultKind::kStoreUnavailable) return record;
  if (!record || record->key != row.key ||
      record->revision != static_cast<std::uint64_t>(row.revision)) {
    return Fail(LostRecord(row.key));
  }
  record->expires = FromMillis(row.expires);
  return record;
}

Result<SessionRow> RowOf(const SessionRecord& record) {
  TRY(auto text, EncodeRecord(record));
  TRY(auto sum, Sha256Hex(text));
  return SessionRow{record.key, static_cast<std::int64_t>(record.revision),
                    ToMillis(record.expires), std::move(sum), std::move(text)};
}

SqliteCode WriteRow(Sqlite& database, const SessionRow& row, const SessionRecord& record,
                    std::int64_t number) {
  const auto meshes = static_cast<std::int64_t>(record.meshes.size());
  const auto handle_sets = static_cast<std::int64_t>(record.handle_sets.size());
  const auto bytes = static_cast<std::int64_t>(row.text.size() + record.BlobBytes());
  if (number == 0) {
    Query add(database,
              "INSERT INTO sessions (owner, id, revision, expires, sum, record, meshes, "
              "handle_sets, incarnation, bytes) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    add.Bind(row.key.owner).Bind(row.key.id).Bind(row.revision).Bind(row.expires).Bind(row.sum);
    add.Bind(row.text).Bind(meshes).Bind(handle_sets).Bind(record.incarnation).Bind(bytes);
    if (add.Run() != SQLITE_OK) return add.code();
    number = sqlite3_last_insert_rowid(database.get());
  } else {
    Query change(database,
                 "UPDATE sessions SET revision = ?, expires = ?, sum = ?, record = ?, meshes = ?, "
                 "handle_sets = ?, incarnation = ?, bytes = ? WHERE number = ?");
    change.Bind(row.revision).Bind(row.expires).Bind(row.sum).Bind(row.text).Bind(meshes);
    change.Bind(handle_sets).Bind(record.incarnation).Bind(bytes).Bind(number);
    if (change.Run() != SQLITE_OK) return change.code();
    Query forget(database, "DELETE FROM blobs WHERE session = ?");
    if (forget.Bind(number).Run() != SQLITE_OK) return forget.code();
  }
  for (const std::string& blob : record.Blobs()) {
    Query name(database, "INSERT INTO blobs VALUES (?, ?)");
    if (name.Bind(number).Bind(blob).Run() != SQLITE_OK) return name.code();
  }
  return SQLITE_OK;
}

}  // namespace arap::store
