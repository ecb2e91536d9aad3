// SPDX-License-Identifier: Apache-2.0
// Accepted tasks, many to a row: a row for each would cost as much as all else that is done for a small task.
#include <cstring>

#include "coordinator/store/as_one.h"
#include "coordinator/store/database.h"
#include "coordinator/store/store.h"

namespace tessera {
namespace {

constexpr std::size_t kTasksOfRow = 1024;

// The header at the front of `headers`, each of which stands behind its length; takes it away.
std::string_view take_header(std::string_view& headers) {
  std::uint32_t length = 0;
  if (headers.size() >= sizeof length) std::memcpy(&length, headers.data(), sizeof length);
  if (headers.size() < sizeof length + length)
    throw StoreDamaged("store.sqlite", "accepted tasks are damaged");
  const std::string_view header = headers.substr(sizeof length, length);
  headers.remove_prefix(sizeof length + length);
  return header;
}

void add_header(std::string& headers, std::string_view header) {
  const auto length = static_cast<std::uint32_t>(header.size());
  headers.append(reinterpret_cast<const char*>(&length), sizeof length).append(header);
}

}  // namespace

// Again is as once: if the journal is then not dropped, the same rows are written another time.
void Store::add_accepted(std::uint64_t job, std::uint32_t place, const Journal& journal) {
  std::string headers;
  std::size_t tasks = 0, part = 0;
  const auto write = [&] {
    if (tasks > 0)
      database_->run(
          "INSERT OR REPLACE INTO accepted(job, place, journal, part, tasks, headers) VALUES(?, ?, ?, ?, ?, "
          "?)",
          job, place, journal.number(), part++, tasks, Database::Blob{headers});
    headers.clear();
    tasks = 0;
  };
  as_one(*database_, [&] {
    journal.each_accepted([&](std::string_view header) {
      add_header(headers, header);
      if (++tasks == kTasksOfRow) write();
    });
    write();
  });
}

std::uint64_t Store::accepted_count(std::uint64_t job) {
  Query found = database_->query("SELECT coalesce(sum(tasks), 0) FROM accepted WHERE job = ?", job);
  return found.next() ? static_cast<std::uint64_t>(found.whole(0)) : 0;
}

std::optional<AcceptedRecord> Store::accepted_at(std::uint64_t job, std::uint64_t index) {
  Query found = database_->query(
      "SELECT place, tasks, headers FROM accepted WHERE job = ? ORDER BY place, journal, part", job);
  while (found.next()) {
    const auto tasks = static_cast<std::uint64_t>(found.whole(1));
    if (index >= tasks) {
      index -= tasks;
      continue;
    }
    const std::string all = found.text(2);
    std::string_view headers = all;
    for (; index > 0; --index) take_header(headers);
    return AcceptedRecord{job, static_cast<std::uint32_t>(found.whole(0)),
                          std::get<Accepted>(event_of(take_header(headers)))};
  }
  return std::nullopt;
}

}  // namespace tessera
