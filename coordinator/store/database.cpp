// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/database.h"

#include <sqlite3.h>

#include <cerrno>

#include "coordinator/store/error.h"

namespace tessera {
namespace {

constexpr std::string_view kRemedy =
    "; move it aside and start again: files and journals beside it are kept, jobs have to be submitted again";

// SQLite knows ENOSPC. A quota (EDQUOT) or a limit on files (EFBIG) is to it a write that failed; but for
// EIO, that of a broken disk, there is no other reason for one.
bool means_full(int result, int system_error) {
  return (result & 0xff) == SQLITE_FULL || (result == SQLITE_IOERR_WRITE && system_error != EIO);
}

}  // namespace

void Database::Close::operator()(sqlite3* handle) const { sqlite3_close(handle); }
void Database::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Database::Database(const std::filesystem::path& file) : file_(file) {
  sqlite3* handle = nullptr;
  const int result = sqlite3_open_v2(
      file.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  handle_.reset(handle);
  check(result);
  sqlite3_extended_result_codes(handle, 1);
  // Exclusive: the log's index is then in memory, not in a file that could shrink beneath us.
  script(
      "PRAGMA locking_mode = EXCLUSIVE; PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;"
      "PRAGMA journal_size_limit = 67108864; PRAGMA foreign_keys = ON;");
  require_sound();
}

Database::~Database() = default;

void Database::require_sound() {
  Query found = query("PRAGMA quick_check(1)");
  const std::string said = found.next() ? found.text(0) : "nothing";
  if (said != "ok") throw StoreDamaged(file_, "is damaged (" + said + ")" + std::string(kRemedy));
}

void Database::check(int result) {
  if (result != SQLITE_OK) fail(result);
}

void Database::fail(int result) {
  const std::string said = handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(result);
  if (handle_ && means_full(result, sqlite3_system_errno(handle_.get())))
    throw StoreFull(file_, "writing failed: " + said);
  const int kind = result & 0xff;
  if (kind == SQLITE_CORRUPT || kind == SQLITE_NOTADB)
    throw StoreDamaged(file_, "is damaged (" + said + ")" + std::string(kRemedy));
  throw StoreError(file_, said);
}

void Database::script(const std::string& sql) {
  check(sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr));
}

sqlite3_stmt* Database::prepared(std::string_view sql) {
  if (const auto found = statements_.find(sql); found != statements_.end()) return found->second.get();
  sqlite3_stmt* statement = nullptr;
  check(sqlite3_prepare_v3(handle_.get(), sql.data(), static_cast<int>(sql.size()), SQLITE_PREPARE_PERSISTENT,
                           &statement, nullptr));
  return statements_.emplace(sql, statement).first->second.get();
}

void Database::bind(sqlite3_stmt* s, int place, std::int64_t value) {
  check(sqlite3_bind_int64(s, place, value));
}

void Database::bind(sqlite3_stmt* s, int place, double value) { check(sqlite3_bind_double(s, place, value)); }

void Database::bind(sqlite3_stmt* s, int place, std::string_view value) {
  check(sqlite3_bind_text64(s, place, value.data(), value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
}

void Database::bind(sqlite3_stmt* s, int place, const Blob& value) {
  const char* bytes = value.bytes.empty() ? "" : value.bytes.data();
  check(sqlite3_bind_blob64(s, place, bytes, value.bytes.size(), SQLITE_TRANSIENT));
}

void Database::bind(sqlite3_stmt* s, int place, const std::optional<double>& value) {
  check(value ? sqlite3_bind_double(s, place, *value) : sqlite3_bind_null(s, place));
}

std::int64_t Database::last_row() const { return sqlite3_last_insert_rowid(handle_.get()); }

bool Database::in_transaction() const { return sqlite3_get_autocommit(handle_.get()) == 0; }

// What failed for want of room may have been rolled back already.
void Database::rollback(bool whole) noexcept {
  if (!in_transaction()) return;
  const char* sql = whole ? "ROLLBACK" : "ROLLBACK TO step; RELEASE step";
  sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr);
}

Query::~Query() {
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

bool Query::next() {
  const int result = sqlite3_step(statement_);
  if (result == SQLITE_ROW) return true;
  if (result != SQLITE_DONE) database_.fail(result);
  return false;
}

std::int64_t Query::whole(int column) const { return sqlite3_column_int64(statement_, column); }
double Query::real(int column) const { return sqlite3_column_double(statement_, column); }
bool Query::is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }

std::string Query::text(int column) const {
  const void* bytes = sqlite3_column_blob(statement_, column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), size);
}

}  // namespace tessera
