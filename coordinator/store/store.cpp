// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/store.h"

#include <fmt/format.h>

#include <charconv>
#include <utility>

#include "coordinator/store/as_one.h"
#include "coordinator/store/database.h"
#include "coordinator/store/lock_file.h"
#include "coordinator/store/schema.h"

namespace tessera {
namespace {

std::filesystem::path made(std::filesystem::path folder) {
  make_folder(folder);
  return folder;
}

// "12-3": the frame at place 3 of job 12.
std::optional<std::pair<std::uint64_t, std::uint32_t>> frame_of(const std::string& name) {
  std::pair<std::uint64_t, std::uint32_t> frame;
  const char* const end = name.data() + name.size();
  const auto job = std::from_chars(name.data(), end, frame.first);
  if (job.ec != std::errc() || job.ptr == end || *job.ptr != '-') return std::nullopt;
  const auto place = std::from_chars(job.ptr + 1, end, frame.second);
  if (place.ec != std::errc() || place.ptr != end) return std::nullopt;
  return frame;
}

}  // namespace

Store::Store(std::filesystem::path folder, BlobOptions options)
    : folder_(made(std::move(folder))),
      lock_(std::make_unique<LockFile>(folder_ / "lock")),
      database_(std::make_unique<Database>(folder_ / "store.sqlite")),
      blobs_(folder_, options) {
  prepare_tables(*database_);
  make_folder(folder_ / "frames");
}

Store::~Store() = default;

Store::Transaction::Transaction(Store& store) : store_(store) { store_.database_->run("BEGIN IMMEDIATE"); }

Store::Transaction::~Transaction() {
  if (open_) store_.database_->rollback();
}

void Store::Transaction::commit() {
  store_.database_->run("COMMIT");
  open_ = false;
}

std::filesystem::path Store::journal_folder(std::uint64_t job, std::uint32_t place) const {
  return folder_ / "frames" / fmt::format("{}-{}", job, place);
}

Journal Store::journal(std::uint64_t job, std::uint32_t place, const std::string& identity) {
  return Journal(journal_folder(job, place), identity);
}

void Store::drop_journal(std::uint64_t job, std::uint32_t place) {
  remove_files(journal_folder(job, place));
  database_->run("DELETE FROM accepted WHERE job = ? AND place = ?", job, place);
}

void Store::checkpoint(std::uint64_t job, std::uint32_t place, Journal& journal,
                       const Checkpoint& checkpoint) {
  add_accepted(job, place, journal);
  journal.restart(checkpoint);
}

void Store::finish(std::uint64_t job, const FrameRecord& frame, Journal journal) {
  as_one(*database_, [&] {
    add_accepted(job, frame.place, journal);
    save(job, frame);
  });
  if (database_->in_transaction()) return;  // it may not count in the end; drop_stale_journals() sees to it
  remove_files(journal_folder(job, frame.place));
}

void Store::drop_stale_journals() {
  std::vector<std::filesystem::path> stale;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "frames")) {
    const auto frame = frame_of(entry.path().filename());
    if (!frame || !is_active(frame->first, frame->second)) stale.push_back(entry.path());
  }
  for (const auto& path : stale) remove_files(path);
}

bool Store::is_active(std::uint64_t job, std::uint32_t place) {
  Query found = database_->query("SELECT state FROM frames WHERE job = ? AND place = ?", job, place);
  return found.next() && found.whole(0) == static_cast<std::int64_t>(FrameState::active);
}

std::uint64_t Store::collect(std::int64_t before) {
  std::set<Digest> referenced;
  Query found = database_->query(
      "SELECT submission FROM jobs UNION SELECT blob FROM needs UNION SELECT image FROM frames"
      " UNION SELECT preview FROM frames UNION SELECT kept FROM frames");
  while (found.next()) referenced.insert(found.text(0));
  return blobs_.remove_unreferenced(referenced, before);
}

}  // namespace tessera
