// SPDX-License-Identifier: Apache-2.0
#include "coordinator/queue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <tuple>

namespace tessera {

bool is_over(JobState state) {
  return state == JobState::completed || state == JobState::failed || state == JobState::cancelled;
}

void Queue::add(QueuedJob job) {
  assert(!jobs_.contains(job.job));
  if (!is_over(job.state)) open_.emplace(job.number, job.job);
  const JobName name = job.job;
  jobs_.emplace(name, std::move(job));
}

const QueuedJob* Queue::find(const JobName& job) const {
  const auto it = jobs_.find(job);
  return it == jobs_.end() ? nullptr : &it->second;
}

bool Queue::ready(const QueuedJob& job) const {
  return job.state == JobState::queued && std::ranges::all_of(job.after, [this](const JobName& name) {
           const QueuedJob* other = find(name);
           return other && other->state == JobState::completed;
         });
}

std::optional<JobName> Queue::next(const FarmRoom& room) const {
  std::map<std::string, int> active;  // by owner
  int highest = -1;                   // priority of an active job
  for (const auto& [number, name] : open_) {
    const QueuedJob& job = jobs_.at(name);
    if (job.state != JobState::active) continue;
    ++active[job.owner];
    highest = std::max(highest, job.priority);
  }
  const QueuedJob* best = nullptr;
  const auto rank = [&active](const QueuedJob& job) {
    const auto of_owner = active.find(job.owner);
    return std::tuple(-job.priority, of_owner == active.end() ? 0 : of_owner->second, job.number);
  };
  for (const auto& [number, name] : open_) {
    const QueuedJob& job = jobs_.at(name);
    if (ready(job) && (!best || rank(job) < rank(*best))) best = &job;
  }
  if (!best || (!room.hungry && best->priority <= highest)) return std::nullopt;
  // It has memory already if it was active before. One that is too big for what is free holds up smaller
  // ones behind it, or it would wait for ever.
  if (!best->begun && best->bytes > room.bytes) return std::nullopt;
  return best->job;
}

std::map<JobName, std::string> Queue::hopeless() const {
  std::map<JobName, std::string> all;
  for (const auto& [number, name] : open_)
    for (const JobName& before : jobs_.at(name).after) {
      const QueuedJob* other = find(before);
      if (!other)
        all[name] = fmt::format("comes after {}, which is not known", before);
      else if (other->state == JobState::failed || other->state == JobState::cancelled)
        all[name] = fmt::format("comes after {}, which {}", before,
                                other->state == JobState::failed ? "failed" : "was cancelled");
    }
  return all;
}

std::string Queue::waits_for(const JobName& name) const {
  const QueuedJob& job = jobs_.at(name);
  if (job.state != JobState::queued) return {};
  std::vector<JobName> open;
  for (const JobName& before : job.after)
    if (const QueuedJob* other = find(before); other && !is_over(other->state)) open.push_back(before);
  return open.empty() ? "waits for room" : fmt::format("waits for {}", fmt::join(open, ", "));
}

void Queue::begin(const JobName& name) {
  QueuedJob& job = jobs_.at(name);
  assert(job.state == JobState::queued);
  job.state = JobState::active;
  job.begun = true;
}

void Queue::pause(const JobName& name) {
  QueuedJob& job = jobs_.at(name);
  if (!is_over(job.state)) job.state = JobState::paused;
}

void Queue::resume(const JobName& name) {
  QueuedJob& job = jobs_.at(name);
  if (job.state == JobState::paused) job.state = job.begun ? JobState::active : JobState::queued;
}

void Queue::set_priority(const JobName& name, int priority) { jobs_.at(name).priority = priority; }

void Queue::forget(const JobName& name) {
  assert(is_over(jobs_.at(name).state));
  jobs_.erase(name);
}

void Queue::end(const JobName& name, JobState how) {
  assert(is_over(how));
  QueuedJob& job = jobs_.at(name);
  job.state = how;
  job.begun = false;
  open_.erase(job.number);
}

}  // namespace tessera
