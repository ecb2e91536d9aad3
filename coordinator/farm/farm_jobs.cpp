// SPDX-License-Identifier: Apache-2.0
// How the farm's jobs begin, go on and end.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "coordinator/farm/farm.h"
#include "coordinator/resume.h"
#include "coordinator/store/kept_image.h"
#include "proto/clock.h"
#include "proto/submission_codec.h"

namespace tessera {
namespace {

constexpr std::size_t kPage = 4096;  // rows read at a time

std::vector<FrameRecord> all_frames(Store& store, std::uint64_t job) {
  std::vector<FrameRecord> all;
  for (;;) {
    const auto page = store.frames(job, static_cast<std::uint32_t>(all.size()), kPage);
    all.insert(all.end(), page.begin(), page.end());
    if (page.size() < kPage) return all;
  }
}

// Frames that ended in an earlier life may have gone by another history than was meant.
void take_keys(OpenJob& job) {
  for (std::size_t i = 0; i < job.frames.size(); ++i)
    if (has_ended(job.frames[i]) && !job.frames[i].image_key.empty()) job.keys[i] = job.frames[i].image_key;
}

}  // namespace

void Farm::recover() {
  for (const JobRecord& record : store_.unfinished_jobs()) try {
      open(record);
    } catch (const Error& e) {
      spdlog::error("job {} is lost: {}", record.job, e.what());
      JobRecord failed = record;
      failed.state = JobState::failed;
      failed.reason = e.what();
      store_.save(failed);
    }
  store_.drop_stale_journals();
  spdlog::info("store: {}, {} jobs to go on with", store_.folder().string(), open_.size());
}

// Also of a job that was active in an earlier life: it begins where that one left it.
void Farm::open(const JobRecord& record) {
  OpenJob job{.record = record, .submission = decode_submission(store_.blobs().read(record.submission))};
  job.bytes = bytes_of(job.submission);
  job.seconds_before = record.seconds;
  job.stamp = static_cast<std::uint64_t>(unix_ms());  // none that an earlier life told
  if (job.record.state == JobState::active) job.record.state = JobState::queued;
  queue_.add({.number = record.number,
              .job = record.job,
              .owner = record.owner,
              .priority = record.priority,
              .after = job.submission.after,
              .bytes = job.bytes,
              .state = job.record.state});
  for (const JobName& before : job.submission.after) {
    if (queue_.find(before)) continue;
    if (const auto other = store_.job(before); other && is_over(other->state))
      queue_.add({.number = other->number, .job = before, .state = other->state});
  }
  open_.emplace(record.job, std::move(job));
}

void Farm::begin_jobs() {
  for (const auto& [name, why] : queue_.hopeless()) end(open_.at(name), JobState::failed, why);
  while (const auto name = queue_.next({memory_free(), hungry()})) {
    OpenJob& job = open_.at(*name);
    try {
      begin(job);
    } catch (const Error& e) {
      end(job, JobState::failed, e.what());
    }
  }
}

// What the frames before have kept for the first ones that are to be done. A frame whose history is damaged
// has the one before done again.
StillToDo Farm::look_for_work(OpenJob& job, std::map<std::size_t, std::shared_ptr<const Image>>& histories) {
  for (;;) {
    StillToDo left = still_to_do(job.jobs, job.frames);
    std::size_t at = 0;
    try {
      for (const auto& [i, blob] : left.histories) {
        at = i;
        histories[i] =
            blob.empty() ? nullptr : std::make_shared<const Image>(get_image(store_.blobs(), blob));
      }
      return left;
    } catch (const StoreError& e) {
      spdlog::error("store: {}; the frame is done again", e.what());
      job.frames[left.places[at] - 1].kept.clear();
      histories.clear();
    }
  }
}

void Farm::begin(OpenJob& job) {
  const JobName name = job.record.job;
  job.jobs = jobs_of(job.submission);
  job.keys = image_keys(job.jobs);
  job.frames = all_frames(store_, job.record.number);
  Shot shot;
  const StillToDo left = look_for_work(job, shot.histories);
  job.places = left.places;
  job.samples_before = 0;
  for (const FrameRecord& f : job.frames) job.samples_before += f.pixel_samples;
  job.begun = clock_now();
  queue_.begin(name);
  if (left.places.empty()) return;  // killed between its last frame and its end
  for (const std::size_t place : left.places) shot.frames.push_back(job.jobs[place]);
  std::vector<std::string> identities;
  for (const std::string& key : job.keys) identities.push_back(key + " " + options_.version);
  take_keys(job);
  job.keeper =
      std::make_shared<FarmKeeper>(store_, job.record.number, left.places, std::move(identities), job.frames,
                                   [this](const std::string& what) { have_trouble(what); });
  JobWatcher watcher{.finished = [this, name](std::size_t i, JobReport r) { ended(name, i, std::move(r)); },
                     .noted =
                         [this, name](std::size_t i, const std::string& text) {
                           OpenJob& noted = open_.at(name);
                           note(noted, fmt::format("frame {}: {}", noted.jobs[noted.places[i]].frame, text));
                         }};
  job.record.state = JobState::active;
  save(job);
  note(job, fmt::format("begun: {} of {} frames to do", left.places.size(), job.jobs.size()));
  job.shot = coordinator_.begin(std::move(shot), standing_of(job), std::move(watcher), job.keeper.get());
}

// Between the owner's jobs of one priority, the first one first.
Standing Farm::standing_of(const OpenJob& job) const {
  return {.rank = job.record.number << 20, .band = job.record.priority, .flow = job.record.owner};
}

void Farm::ended(const JobName& name, std::size_t i, JobReport report) {
  changed_ = true;
  OpenJob& job = open_.at(name);
  const std::size_t place = job.places[i];
  if (report.failure) return file_failed(job, place, report);
  FrameRecord& frame = job.frames[place];
  frame.seconds = report.seconds;
  frame.rounds = report.image.rounds;
  frame.errors = report.errors;
  frame.pixel_samples = static_cast<std::uint64_t>(report.image.pixel_samples);
  frame.acceptable_share = report.image.acceptable_share;
  if (report.image.rounds > 0) frame.error = report.image.error.mean;
  job.samples_before += frame.pixel_samples;
  ++job.writing;
  frame.image_key = job.keys[place] = key_as_made(job.jobs, job.keys, place, report.continued);
  clerk_.write({name, place, job.jobs[place], std::move(report), style_of(job.submission, options_.version),
                frame.image_key});
}

void Farm::save(OpenJob& job) try {
  changed(job);
  store_.save(job.record);
} catch (const Error& e) {
  have_trouble(e.what());
}

// Those who wait for it are told.
void Farm::changed(OpenJob& job) {
  ++job.stamp;
  coordinator_.news();
}

double Farm::seconds_of(const OpenJob& job) const {
  const double now = job.shot ? seconds_between(job.begun, clock_now()) : 0;
  return job.seconds_before + now;
}

void Farm::keep_limits() {
  for (auto& [name, job] : open_) {
    if (!job.shot || job.limit_reached || coordinator_.over(*job.shot)) continue;
    const JobLimits& limits = job.submission.limits;
    std::uint64_t samples = job.samples_before;
    for (const auto& [i, frame] : coordinator_.frames(*job.shot))
      samples += static_cast<std::uint64_t>(frame.state->frame->progress(0).samples_done);
    if (limits.seconds && seconds_of(job) > *limits.seconds)
      job.limit_reached = fmt::format("its limit of {:.0f} s is reached", *limits.seconds);
    else if (limits.pixel_samples && samples > *limits.pixel_samples)
      job.limit_reached = fmt::format("its limit of {} pixel samples is reached", *limits.pixel_samples);
    if (job.limit_reached) coordinator_.interrupt(*job.shot);
  }
}

void Farm::end_jobs() {
  std::vector<JobName> over;
  for (const auto& [name, job] : open_)
    if (queue_.find(name)->begun && job.writing == 0 && (!job.shot || coordinator_.over(*job.shot)))
      over.push_back(name);
  for (const JobName& name : over) {
    OpenJob& job = open_.at(name);
    const auto failed = std::ranges::count(job.frames, FrameState::failed, &FrameRecord::state);
    if (job.limit_reached)
      end(job, JobState::failed, *job.limit_reached);
    else if (failed > 0)
      end(job, JobState::failed,
          fmt::format("{} of {} frames failed: {}", failed, job.frames.size(),
                      std::ranges::find(job.frames, FrameState::failed, &FrameRecord::state)->reason));
    else
      end(job, JobState::completed, "");
  }
}

void Farm::end(OpenJob& job, JobState how, const std::string& reason) {
  const JobName name = job.record.job;
  const std::vector<JobName> before = job.submission.after;
  job.record.seconds = seconds_of(job);
  if (job.shot && !coordinator_.over(*job.shot)) coordinator_.drop(*job.shot);
  job.record.state = how;
  job.record.reason = reason;
  save(job);
  note(job, reason.empty() ? "completed" : fmt::format("ended: {}", reason));
  changed_ = true;  // others may come after it, or take its room
  ++ended_jobs_.at(static_cast<std::size_t>(how));
  previews_.forget(name);
  queue_.end(name, how);
  open_.erase(name);
  forget_if_alone(name);
  for (const JobName& other : before) forget_if_alone(other);
}

// The queue knows jobs that are over as long as others come after them.
void Farm::forget_if_alone(const JobName& name) {
  if (queue_.find(name) && !open_.contains(name) && !comes_before(name)) queue_.forget(name);
}

std::optional<JobName> Farm::comes_before(const JobName& name) const {
  for (const auto& [other, job] : open_)
    if (std::ranges::count(job.submission.after, name) > 0) return other;
  return std::nullopt;
}

}  // namespace tessera
