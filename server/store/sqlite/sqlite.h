// Sqlite: a thin hull around one connection of SQLite and its prepared statements.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

#include <sqlite3.h>

#include "arap/base/result.h"

namespace arap::store {

// What SQLite calls it: SQLITE_OK, SQLITE_FULL… (the primary code, without its extension).
using SqliteCode = int;

// A value or the code that kept us from it.
template <class T>
using SqliteResult = tl::expected<T, SqliteCode>;

// One connection. Not thread-safe; movable.
class Sqlite {
 public:
  enum class Missing { kCreate, kRefuse };

  // Opens the database `path`. SQLITE_CANTOPEN for one that is missing and to be refused.
  static SqliteResult<Sqlite> Open(const std::string& path, Missing missing);

  // Runs statements that give no rows, or whose rows do not matter.
  SqliteCode Run(const std::string& sql);

  // The prepared statement of `sql`, which must be a literal: it is found again by its address.
  // Null when it cannot be prepared.
  sqlite3_stmt* Prepared(const char* sql);

  sqlite3* get() const { return connection_.get(); }
  SqliteCode last_code() const { return sqlite3_errcode(get()); }

 private:
  struct Close {
    void operator()(sqlite3* connection) const { sqlite3_close_v2(connection); }
  };
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };

  // Destroyed in the reverse order: the statements go before their connection.
  std::unique_ptr<sqlite3, Close> connection_;
  std::unordered_map<const void*, std::unique_ptr<sqlite3_stmt, Finalize>> statements_;
};

// One run of a prepared statement. Binds in order, then steps. After an error it does nothing more.
class Query {
 public:
  Query(Sqlite& database, const char* sql);
  ~Query();
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  Query& Bind(std::int64_t number);
  // The text must live as long as the query.
  Query& Bind(std::string_view text);

  // True: there is a row. False: there are no more, or an error.
  bool Row();
  // For what gives no rows.
  SqliteCode Run();
  // SQLITE_OK unless something failed.
  SqliteCode code() const { return code_; }

  std::int64_t Int(int column) const;
  std::string Text(int column) const;

 private:
  sqlite3_stmt* statement_ = nullptr;
  SqliteCode code_ = SQLITE_OK;
  int bound_ = 0;
};

// A transaction that writes. Rolled back unless committed.
class Transaction {
 public:
  explicit Transaction(Sqlite& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  // Of the beginning.
  SqliteCode code() const { return code_; }
  SqliteCode Commit();

 private:
  Sqlite& database_;
  SqliteCode code_;
};

}  // namespace arap::store
