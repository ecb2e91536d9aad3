// SPDX-License-Identifier: Apache-2.0
#include "coordinator/coordinator.h"

#include <algorithm>

#include "proto/clock.h"

namespace tessera {
namespace {

constexpr Millis kLongestSleep{1000};  // so that progress is shown while nothing is heard

double seconds_between(Instant from, Instant to) { return std::chrono::duration<double>(to - from).count(); }

}  // namespace

Coordinator::Active::Active(JobId job_id, const Job& job, const ShotPlan::Start& start, Instant now)
    : id(job_id), place(start.frame), started(now), frame(job, start.awaits_history) {
  if (!start.awaits_history) frame.remember(start.history);
}

Coordinator::Coordinator(Transport& road, const CoordinatorOptions& options)
    : road_(road),
      options_(options),
      scheduler_(options.scheduler),
      next_job_(options.first_id),
      next_task_(options.first_id) {}

Coordinator::~Coordinator() = default;

JobReport Coordinator::run(const Job& job, const JobWatcher& watcher) {
  JobReport ended;
  JobWatcher own = watcher;
  own.finished = [&](std::size_t frame, const JobReport& report) {
    ended = report;
    if (watcher.finished) watcher.finished(frame, report);
  };
  run(Shot{{job}}, own);
  return ended;
}

void Coordinator::run(const Shot& shot, const JobWatcher& watcher) {
  validate(shot);
  shot_ = ShotPlan(shot);
  watcher_ = &watcher;
  begun_ = clock_now();
  Instant next_progress = begun_;
  begin_frames(begun_);
  while (!shot_.over()) {
    std::optional<Mail> mail = road_.receive(next_wake(clock_now()));
    const Instant now = clock_now();
    if (mail)
      hear(std::move(*mail), now);
    else
      tell(TimePassed{}, now);
    for (auto& [id, active] : active_) advance(active, now);
    const bool one_ended = std::ranges::any_of(active_, [](const auto& a) { return a.second.over(); });
    if (watcher.progress && (now >= next_progress || one_ended)) {
      watcher.progress(progress(now));
      next_progress = now + watcher.interval;
    }
    if (snapshot_wanted_.exchange(false) && watcher.snapshot)
      for (const auto& [id, active] : active_) watcher.snapshot(active.place, report(active, now));
    if (one_ended) end_frames(now);
  }
  if (watcher.progress && shot.frames.size() > 1) watcher.progress(progress(clock_now()));
  watcher_ = nullptr;
}

void Coordinator::begin_frames(Instant now) {
  if (interrupted_) shot_.stop();
  while (const auto start = shot_.start()) {
    const JobId id = next_job_++;
    Active& active = active_.try_emplace(id, id, shot_.frames()[start->frame], *start, now).first->second;
    add(active, active.frame.begin(), now);
  }
}

void Coordinator::end_frames(Instant now) {
  for (auto it = active_.begin(); it != active_.end();) {
    if (!it->second.over()) {
      ++it;
      continue;
    }
    const auto ended = active_.extract(it++);
    dismiss(ended.mapped(), now);
    hand_on(ended.mapped(), now);
  }
  begin_frames(now);
}

// What the frame kept goes to the next one, before anybody is told: workers are not to wait for that.
void Coordinator::hand_on(const Active& ended, Instant now) {
  const JobReport report = Coordinator::report(ended, now);
  if (const auto next = shot_.end(ended.place, report.kept))
    for (auto& [id, active] : active_)
      if (active.place == *next) add(active, active.frame.remember(report.kept), now);
  if (watcher_->finished) watcher_->finished(ended.place, report);
}

void Coordinator::interrupt() {
  interrupted_ = true;
  road_.wake();
}

void Coordinator::fail(const std::string& reason) {
  {
    const std::lock_guard lock(failing_);
    failure_ = reason;
  }
  road_.wake();
}

void Coordinator::request_snapshot() {
  snapshot_wanted_ = true;
  road_.wake();
}

Instant Coordinator::next_wake(Instant now) const {
  Instant wake = now + kLongestSleep;
  if (const auto deadline = scheduler_.next_deadline()) wake = std::min(wake, *deadline);
  return std::max(wake, now);
}

void Coordinator::add(Active& active, const std::vector<Work>& work, Instant now) {
  if (work.empty()) return;
  Submitted submitted{{}, {.rank = static_cast<std::uint32_t>(active.place)}};
  for (const Work& w : work) {
    const TaskId id = next_task_++;
    tasks_.emplace(id, Task{id, active.id, w});
    submitted.tasks.push_back({id, active.id});
  }
  tell(submitted, now);
}

void Coordinator::advance(Active& a, Instant now) {
  const AcceptanceRule& rule = a.frame.job().acceptance;
  const double seconds = seconds_between(a.started, now);
  if (const std::lock_guard lock(failing_); failure_) a.failure = failure_;
  if (a.over()) return;
  if (interrupted_) return a.frame.stop(StopReason::interrupted);
  if (rule.max_seconds && seconds >= *rule.max_seconds && a.frame.seen())
    return a.frame.stop(StopReason::max_seconds);
  if (a.frame.round_complete()) add(a, a.frame.look({seconds}), now);
}

// The job is over: nobody need work on it any more.
void Coordinator::dismiss(const Active& active, Instant now) {
  std::erase_if(tasks_, [&](const auto& t) { return t.second.job == active.id; });
  tell(WithdrawnJob{active.id}, now);
  for (const WorkerId& worker : active.offered) road_.send(worker, JobOver{active.id});
}

Progress Coordinator::progress(Instant now) const {
  const int frames = static_cast<int>(shot_.frames().size());
  Progress p{.fraction = 1};  // but for
  if (!active_.empty()) {
    const Active& first = active_.begin()->second;
    p = first.frame.progress(seconds_between(first.started, now));
    if (frames == 1) return p;
  }
  double whole = shot_.done();
  for (const auto& [id, active] : active_)
    whole += active.frame.progress(seconds_between(active.started, now)).fraction;
  p.frames = frames;
  p.frames_done = shot_.done();
  p.fraction = shot_.over() ? 1 : std::min(0.999, whole / frames);
  p.seconds = seconds_between(begun_, now);
  if (whole > 0) p.seconds_left = p.seconds * (frames - whole) / whole;
  return p;
}

JobReport Coordinator::report(const Active& a, Instant now) {
  const bool keeps = !a.failure && a.frame.stopped() && a.frame.job().filter.history() > 0;
  return {.image = a.frame.image(),
          .seconds = seconds_between(a.started, now),
          .dropped = a.dropped,
          .device_classes = a.device_classes,
          .failure = a.failure,
          .bad_input = a.bad_input,
          .kept = keeps ? a.frame.kept() : nullptr,
          .continued = a.frame.continued()};
}

}  // namespace tessera
