// The database of sessions in a directory: how it is opened, how a damaged one is replaced by a new
// one with all that can be read, and what the codes of SQLite mean to the store.
#pragma once

#include <optional>
#include <string>

#include "arap/base/result.h"
#include "server/store/sqlite/sqlite.h"
#include "server/store/store.h"

namespace arap::store {

struct OpenedDatabase {
  Sqlite database;
  std::optional<Recovery> recovery;  // it was damaged
};

// How much is looked at before a database is trusted.
enum class Trust {
  kCheck,    // every page, and it is created when missing: for the start, and after damage was seen
  kAsItWas,  // none, and it has to be there: after a fault of the disk
};

// Opens sessions.db in `directory` for this process alone: WAL, synchronous = FULL. What is damaged
// is recovered. kStoreUnavailable when it cannot be read or written, or is of a later version.
Result<OpenedDatabase> OpenDatabase(const std::string& directory, Trust trust);

// What the codes mean to the store.

// kStoreUnavailable with the cause in words.
Fault SqliteFault(SqliteCode code);

// The file is no database of this version any more, or a page of it is damaged.
bool IsDamage(SqliteCode code);

// The connection may not be good after this; a new one might be.
bool IsBroken(SqliteCode code);

}  // namespace arap::store
