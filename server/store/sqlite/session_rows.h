// Session records in SQLite: the tables, and how a record becomes rows.
#pragma once

#include <cstdint>
#include <string>

#include "arap/base/result.h"
#include "server/store/sqlite/sqlite.h"
#include "server/store/store.h"

namespace arap::store {

// user_version of the tables below.
inline constexpr std::int64_t kSchemaVersion = 2;

// Makes the tables in an empty database, in one transaction.
//   sessions  one row per record: what is asked for often beside the text of record_format.h, whose
//             SHA-256 is kept in `sum`. `expires` counts; the one in the text is that of the last
//             Put.
//   blobs     which blobs a record names
//   owners    how much an owner has, kept by triggers
SqliteCode CreateTables(Sqlite& database);
// Changes the tables of user_version 1 into these, in one transaction.
SqliteCode UpgradeTables(Sqlite& database);
// SQLITE_OK when the tables are as this version makes them.
SqliteCode CheckTables(Sqlite& database);

// A row of `sessions` as it is stored.
struct SessionRow {
  SessionKey key;
  std::int64_t revision = 0;
  std::int64_t expires = 0;
  std::string sum;
  std::string text;
};

// The columns of a SessionRow, in the order that ReadRow expects.
#define ARAP_SESSION_COLUMNS "owner, id, revision, expires, sum, record"
SessionRow ReadRow(const Query& query);

// kDataLoss unless the text is what was written for this key; kStoreUnavailable for what a later
// version wrote.
Result<SessionRecord> RecordOf(const SessionRow& row);

// The row of a record. kInternal when it cannot be written down.
Result<SessionRow> RowOf(const SessionRecord& record);

// Adds or, with the number of the row that is there, replaces; within a transaction of the caller.
SqliteCode WriteRow(Sqlite& database, const SessionRow& row, const SessionRecord& record,
                    std::int64_t number);

}  // namespace arap::store
