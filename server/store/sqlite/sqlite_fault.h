// What SQLite's result codes mean to the store.
#pragma once

#include "arap/base/fault.h"
#include "server/store/sqlite/sqlite.h"

namespace arap::store {

// kStoreUnavailable with the cause in words.
Fault SqliteFault(SqliteCode code);

// The file is no database of this version any more, or a page of it is damaged.
bool IsDamage(SqliteCode code);

// The connection may not be good after this; a new one might be.
bool IsBroken(SqliteCode code);

}  // namespace arap::store
