// SPDX-License-Identifier: Apache-2.0
// Accepted tasks, as rows.
#include <fmt/format.h>

#include "coordinator/store/as_one.h"
#include "coordinator/store/database.h"
#include "coordinator/store/store.h"

namespace tessera {
namespace {

std::string text_of(const Region& r) { return fmt::format("{},{},{},{}", r.x0, r.y0, r.x1, r.y1); }

// What tells a frame's tasks apart.
std::string key_of(const Accepted& task) {
  if (const auto* render = std::get_if<RenderTask>(&task.work))
    return fmt::format("render {} {}-{}", text_of(render->region), render->samples.begin,
                       render->samples.end);
  return fmt::format("filter {} {}", text_of(std::get<FilterTask>(task.work).tile.inner), task.round);
}

}  // namespace

// Again is as once: a checkpoint that was not reached leaves its tasks in the journal, too.
void Store::add_accepted(std::uint64_t job, std::uint32_t place, std::span<const Accepted> tasks) {
  as_one(*database_, [&] {
    for (const Accepted& task : tasks)
      database_->run("INSERT OR REPLACE INTO accepted(job, place, work, result) VALUES(?, ?, ?, ?)", job,
                     place, key_of(task), Database::Blob{header_of(task, {})});
  });
}

std::uint64_t Store::accepted_count(std::uint64_t job) {
  Query found = database_->query("SELECT count(*) FROM accepted WHERE job = ?", job);
  return found.next() ? static_cast<std::uint64_t>(found.whole(0)) : 0;
}

std::optional<AcceptedRecord> Store::accepted_at(std::uint64_t job, std::uint64_t index) {
  Query found = database_->query(
      "SELECT place, result FROM accepted WHERE job = ? ORDER BY place, work LIMIT 1 OFFSET ?", job, index);
  if (!found.next()) return std::nullopt;
  return AcceptedRecord{job, static_cast<std::uint32_t>(found.whole(0)),
                        std::get<Accepted>(event_of(found.text(1)))};
}

}  // namespace tessera
