// SPDX-License-Identifier: Apache-2.0
// Jobs, their frames and their events, as rows.
#include <fmt/format.h>

#include <cstring>

#include "coordinator/store/as_one.h"
#include "coordinator/store/database.h"
#include "coordinator/store/store.h"

namespace tessera {
namespace {

template <class Enum>
Enum enum_of(std::int64_t value, Enum last) {
  if (value < 0 || value > static_cast<std::int64_t>(last))
    throw StoreDamaged("store.sqlite", "holds a state that there is not");
  return static_cast<Enum>(value);
}

std::string_view bytes_of(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

std::vector<float> floats_of(const std::string& bytes) {
  std::vector<float> values(bytes.size() / sizeof(float));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
  return values;
}

JobRecord job_of(const Query& row) {
  return {.number = static_cast<std::uint64_t>(row.whole(0)),
          .job = row.text(1),
          .submission = row.text(2),
          .name = row.text(3),
          .owner = row.text(4),
          .submitted = row.whole(5),
          .state = enum_of(row.whole(6), JobState::cancelled),
          .reason = row.text(7),
          .priority = static_cast<int>(row.whole(8)),
          .seconds = row.real(9),
          .pixel_samples = static_cast<std::uint64_t>(row.whole(10)),
          .failed_tasks = static_cast<std::uint64_t>(row.whole(11))};
}

std::vector<JobRecord> all_jobs(Query rows) {
  std::vector<JobRecord> all;
  while (rows.next()) all.push_back(job_of(rows));
  return all;
}

FrameRecord frame_of(const Query& row) {
  FrameRecord frame{.place = static_cast<std::uint32_t>(row.whole(0)),
                    .frame = static_cast<int>(row.whole(1)),
                    .state = enum_of(row.whole(2), FrameState::failed),
                    .reason = row.text(3),
                    .image_key = row.text(4),
                    .image = row.text(5),
                    .preview = row.text(6),
                    .kept = row.text(7),
                    .rounds = static_cast<int>(row.whole(8)),
                    .seconds = row.real(9),
                    .pixel_samples = static_cast<std::uint64_t>(row.whole(10)),
                    .error = {},
                    .acceptable_share = row.real(12),
                    .errors = floats_of(row.text(13))};
  if (!row.is_null(11)) frame.error = row.real(11);
  return frame;
}

const std::string kJobs =
    "SELECT number, job, submission, name, owner, submitted, state, reason, priority, seconds, pixel_samples,"
    " failed_tasks FROM jobs ";

bool is_same(const JobRecord& a, const JobRecord& b) {
  return a.submission == b.submission && a.owner == b.owner;
}

}  // namespace

Store::Added Store::add(const JobRecord& job, std::span<const FrameRecord> frames,
                        std::span<const Digest> blobs) {
  if (auto there = this->job(job.job)) {
    if (is_same(*there, job)) return {std::move(*there), false};
    throw Error(ExitCode::bad_usage,
                fmt::format("job {}: another one of that name is there already", job.job));
  }
  JobRecord added = job;
  as_one(*database_, [&] {
    database_->run(
        "INSERT INTO jobs(job, submission, name, owner, submitted, state, reason, priority, seconds,"
        " pixel_samples, failed_tasks) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        job.job, job.submission, job.name, job.owner, job.submitted, static_cast<int>(job.state), job.reason,
        job.priority, job.seconds, job.pixel_samples, job.failed_tasks);
    added.number = static_cast<std::uint64_t>(database_->last_row());
    for (const FrameRecord& frame : frames) save(added.number, frame);
    for (const Digest& blob : blobs)
      database_->run("INSERT OR IGNORE INTO needs(job, blob) VALUES(?, ?)", added.number, blob);
  });
  return {added, true};
}

std::optional<JobRecord> Store::job(const JobName& job) {
  auto found = all_jobs(database_->query(kJobs + "WHERE job = ?", job));
  return found.empty() ? std::nullopt : std::optional(std::move(found.front()));
}

std::vector<JobRecord> Store::jobs(std::uint64_t after, std::size_t most) {
  return all_jobs(database_->query(kJobs + "WHERE number > ? ORDER BY number LIMIT ?", after, most));
}

std::vector<JobRecord> Store::unfinished_jobs() {
  return all_jobs(database_->query(kJobs + "WHERE state IN (?, ?, ?) ORDER BY number",
                                   static_cast<int>(JobState::queued), static_cast<int>(JobState::active),
                                   static_cast<int>(JobState::paused)));
}

void Store::save(const JobRecord& job) {
  database_->run(
      "UPDATE jobs SET state = ?, reason = ?, priority = ?, seconds = ?, pixel_samples = ?, failed_tasks = ?"
      " WHERE number = ?",
      static_cast<int>(job.state), job.reason, job.priority, job.seconds, job.pixel_samples, job.failed_tasks,
      job.number);
}

void Store::remove(std::uint64_t job) { database_->run("DELETE FROM jobs WHERE number = ?", job); }

std::vector<FrameRecord> Store::frames(std::uint64_t job, std::uint32_t from, std::size_t most) {
  Query rows = database_->query(
      "SELECT place, frame, state, reason, image_key, image, preview, kept, rounds, seconds, pixel_samples,"
      " error, acceptable_share, errors FROM frames WHERE job = ? AND place >= ? ORDER BY place LIMIT ?",
      job, from, most);
  std::vector<FrameRecord> all;
  while (rows.next()) all.push_back(frame_of(rows));
  return all;
}

void Store::save(std::uint64_t job, const FrameRecord& f) {
  database_->run(
      "INSERT OR REPLACE INTO frames(job, place, frame, state, reason, image_key, image, preview, kept, "
      "rounds,"
      " seconds, pixel_samples, error, acceptable_share, errors) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, "
      "?,"
      " ?, ?)",
      job, f.place, f.frame, static_cast<int>(f.state), f.reason, f.image_key, f.image, f.preview, f.kept,
      f.rounds, f.seconds, f.pixel_samples, f.error, f.acceptable_share, Database::Blob{bytes_of(f.errors)});
}

std::uint64_t Store::add_event(std::uint64_t job, std::int64_t when, std::string_view text) {
  Query row = database_->query(
      "INSERT INTO events(job, number, moment, text) SELECT ?1, 1 + coalesce(max(number), 0), ?2, ?3 FROM "
      "events"
      " WHERE job = ?1 RETURNING number",
      job, when, text);
  const std::uint64_t number = row.next() ? static_cast<std::uint64_t>(row.whole(0)) : 0;
  while (row.next()) {
  }
  return number;
}

std::vector<JobEvent> Store::events(std::uint64_t job, std::uint64_t after, std::size_t most) {
  Query rows = database_->query(
      "SELECT number, moment, text FROM events WHERE job = ? AND number > ? ORDER BY number LIMIT ?", job,
      after, most);
  std::vector<JobEvent> all;
  while (rows.next()) all.push_back({static_cast<std::uint64_t>(rows.whole(0)), rows.whole(1), rows.text(2)});
  return all;
}

Store::FrameCounts Store::count_frames(std::uint64_t job) {
  FrameCounts counts;
  Query found = database_->query("SELECT state, count(*) FROM frames WHERE job = ? GROUP BY state", job);
  while (found.next()) {
    const auto state = static_cast<FrameState>(found.whole(0));
    const auto n = static_cast<std::uint32_t>(found.whole(1));
    counts.all += n;
    if (state == FrameState::completed || state == FrameState::limited) counts.done += n;
    if (state == FrameState::failed) counts.failed += n;
  }
  return counts;
}

}  // namespace tessera
