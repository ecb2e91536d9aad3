// SPDX-License-Identifier: Apache-2.0
// What the farm tells of itself to those who watch over it.
#include <algorithm>

#include "coordinator/farm/farm.h"

namespace tessera {
namespace {

constexpr Millis kPublication{1000}, kOfLate{10'000};

}  // namespace

void Farm::publish(Instant now) {
  if (!options_.publish || (now < next_publication_ && trouble_ == published_trouble_)) return;
  next_publication_ = now + kPublication;
  published_trouble_ = trouble_;
  samples_.emplace_back(now, coordinator_.counts().pixel_samples);
  while (now - samples_.front().first > kOfLate && samples_.size() > 2) samples_.pop_front();
  options_.publish(figures(now));
}

FarmFigures Farm::figures(Instant now) const {
  const WorkCounts& work = coordinator_.counts();
  FarmFigures f{.version = options_.version,
                .seconds = seconds_between(began_, now),
                .trouble = trouble_,
                .tasks = coordinator_.scheduler().counts(),
                .pixel_samples = work.pixel_samples,
                .bytes_in = work.bytes_in,
                .bytes_out = work.bytes_out,
                .failed_tasks = work.failed,
                .wrong_bits = wrong_bits_,
                .jobs = ended_jobs_,
                .memory_free = memory_free(),
                .store_bytes = store_.blobs().bytes()};
  f.memory_used = options_.memory - f.memory_free;
  for (const auto& [id, worker] : coordinator_.workers()) f.slots += worker.present ? worker.slots : 0;
  if (samples_.size() > 1 && now > samples_.front().first)
    f.samples_per_second = static_cast<double>(work.pixel_samples - samples_.front().second) /
                           seconds_between(samples_.front().first, now);
  std::vector<const OpenJob*> active;
  for (const auto& [name, job] : open_) {
    ++f.jobs.at(static_cast<std::size_t>(job.record.state));
    if (job.record.state == JobState::active) active.push_back(&job);
  }
  std::ranges::sort(active, {}, [](const OpenJob* job) { return job->record.number; });
  for (const OpenJob* job : active)
    if (f.active.size() < kMostJobs) f.active.push_back(figures(*job));
  return f;
}

// From memory alone: the store may have to be read for a job, but not once a second.
JobFigures Farm::figures(const OpenJob& job) const {
  JobFigures f{.job = job.record.job, .target = job.submission.job.acceptance.relmse};
  double done = static_cast<double>(job.writing);
  for (const FrameRecord& frame : job.frames)
    done += frame.state == FrameState::completed || frame.state == FrameState::limited ||
            frame.state == FrameState::failed;
  if (job.shot)
    for (const auto& [i, frame] : coordinator_.frames(*job.shot)) {
      const Progress p = frame.state->frame->progress(frame.seconds);
      done += p.fraction;
      if (p.error) f.error = std::max(f.error.value_or(0), *p.error);
    }
  f.fraction =
      std::min(1.0, done / static_cast<double>(std::max<std::size_t>(1, job.submission.frames.size())));
  return f;
}

}  // namespace tessera
