// SPDX-License-Identifier: Apache-2.0
// A SQLite database, its statements as objects. With its .cpp the only files that see SQLite.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

struct sqlite3;
struct sqlite3_stmt;

namespace tessera {

class Database;

// A statement under way: rows come one by one. Ends with the object.
class Query {
 public:
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;
  ~Query();

  // The next row, if there is one.
  bool next();
  // Columns of the row, from 0.
  std::int64_t whole(int column) const;
  double real(int column) const;
  std::string text(int column) const;  // or bytes
  bool is_null(int column) const;

 private:
  friend class Database;
  Query(Database& database, sqlite3_stmt* statement) : database_(database), statement_(statement) {}

  Database& database_;
  sqlite3_stmt* statement_;
};

class Database {
 public:
  // Bytes as they are, not text.
  struct Blob {
    std::string_view bytes;
  };

  // Opens or creates it: for this process alone, in WAL mode. Throws StoreDamaged if it is damaged, and what
  // the methods below throw.
  explicit Database(const std::filesystem::path& file);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // All throw StoreFull, StoreDamaged or StoreError. Values take the places of the question marks: whole
  // numbers, doubles, text, Blob, optional<double>. Statements are kept, so `sql` is one of a few.
  template <class... Values>
  Query query(std::string_view sql, const Values&... values) {
    sqlite3_stmt* statement = prepared(sql);
    int place = 0;
    (bind_value(statement, ++place, values), ...);
    return Query(*this, statement);
  }
  template <class... Values>
  void run(std::string_view sql, const Values&... values) {
    Query all = query(sql, values...);
    while (all.next()) {
    }
  }
  // Several statements without values.
  void script(const std::string& sql);

  const std::filesystem::path& file() const { return file_; }
  std::int64_t last_row() const;  // of the last insert
  bool in_transaction() const;
  // Of the transaction, or of the savepoint "step" in it.
  void rollback(bool whole = true) noexcept;

 private:
  friend class Query;
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };

  template <class Value>
  void bind_value(sqlite3_stmt* statement, int place, const Value& value) {
    if constexpr (std::is_integral_v<Value>)
      bind(statement, place, static_cast<std::int64_t>(value));
    else
      bind(statement, place, value);
  }
  sqlite3_stmt* prepared(std::string_view sql);
  void bind(sqlite3_stmt*, int place, std::int64_t value);
  void bind(sqlite3_stmt*, int place, double value);
  void bind(sqlite3_stmt*, int place, std::string_view value);
  void bind(sqlite3_stmt*, int place, const Blob& value);
  void bind(sqlite3_stmt*, int place, const std::optional<double>& value);
  void check(int result);
  [[noreturn]] void fail(int result);
  void require_sound();

  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> handle_;
  std::map<std::string, std::unique_ptr<sqlite3_stmt, Finalize>, std::less<>> statements_;
};

}  // namespace tessera
