// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/schema.h"

#include <fmt/format.h>

#include "coordinator/store/error.h"

namespace tessera {
namespace {

constexpr std::int64_t kApplication = 0x54534552;  // "TSER"

constexpr const char* kTables = R"(
CREATE TABLE jobs(
  number INTEGER PRIMARY KEY AUTOINCREMENT, job TEXT NOT NULL UNIQUE, submission TEXT NOT NULL,
  name TEXT NOT NULL, owner TEXT NOT NULL, submitted INTEGER NOT NULL,
  state INTEGER NOT NULL, reason TEXT NOT NULL, priority INTEGER NOT NULL, seconds REAL NOT NULL,
  pixel_samples INTEGER NOT NULL, failed_tasks INTEGER NOT NULL);
CREATE TABLE frames(
  job INTEGER NOT NULL REFERENCES jobs(number) ON DELETE CASCADE, place INTEGER NOT NULL,
  frame INTEGER NOT NULL, state INTEGER NOT NULL, reason TEXT NOT NULL, image_key TEXT NOT NULL,
  image TEXT NOT NULL, preview TEXT NOT NULL, kept TEXT NOT NULL, rounds INTEGER NOT NULL,
  seconds REAL NOT NULL, pixel_samples INTEGER NOT NULL, error REAL, acceptable_share REAL NOT NULL,
  errors BLOB NOT NULL, PRIMARY KEY(job, place)) WITHOUT ROWID;
CREATE TABLE needs(
  job INTEGER NOT NULL REFERENCES jobs(number) ON DELETE CASCADE, blob TEXT NOT NULL,
  PRIMARY KEY(job, blob)) WITHOUT ROWID;
CREATE TABLE events(
  job INTEGER NOT NULL REFERENCES jobs(number) ON DELETE CASCADE, number INTEGER NOT NULL,
  moment INTEGER NOT NULL, text TEXT NOT NULL, PRIMARY KEY(job, number)) WITHOUT ROWID;
CREATE TABLE accepted(
  job INTEGER NOT NULL REFERENCES jobs(number) ON DELETE CASCADE, place INTEGER NOT NULL,
  journal INTEGER NOT NULL, part INTEGER NOT NULL, tasks INTEGER NOT NULL, headers BLOB NOT NULL,
  PRIMARY KEY(job, place, journal, part)) WITHOUT ROWID;
)";

std::int64_t pragma(Database& database, std::string_view sql) {
  Query found = database.query(sql);
  return found.next() ? found.whole(0) : 0;
}

}  // namespace

void prepare_tables(Database& database) {
  const std::int64_t version = pragma(database, "PRAGMA user_version");
  const std::int64_t application = pragma(database, "PRAGMA application_id");
  const bool empty = pragma(database, "SELECT count(*) FROM sqlite_schema") == 0;
  if (!empty && (application != kApplication || version < 1))
    throw StoreError(database.file(), "is not a store of tessera", ExitCode::bad_input);
  if (version > kStoreVersion)
    throw StoreError(
        database.file(),
        fmt::format("is a store of version {}; this program knows {} at the most", version, kStoreVersion),
        ExitCode::bad_input);
  if (!empty) return;
  database.script(
      fmt::format("BEGIN IMMEDIATE; {} PRAGMA application_id = {}; PRAGMA user_version = {}; COMMIT;",
                  kTables, kApplication, kStoreVersion));
}

}  // namespace tessera
