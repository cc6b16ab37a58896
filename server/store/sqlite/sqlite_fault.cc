#include "server/store/sqlite/sqlite_fault.h"

#include "server/store/store_fault.h"

namespace arap::store {

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
