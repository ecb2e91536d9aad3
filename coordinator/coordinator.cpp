// SPDX-License-Identifier: Apache-2.0
#include "coordinator/coordinator.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "proto/clock.h"

namespace tessera {
namespace {

constexpr Millis kLongestSleep{1000};  // so that progress is shown while nothing is heard
constexpr int kMailsATurn = 256;       // before frames are looked at again

Instant before(Instant now, double seconds) {
  return now - std::chrono::duration_cast<Instant::duration>(std::chrono::duration<double>(seconds));
}

// Precondition: it is not given, for there is nobody to ask for its planes.
Keeper::Begun begin_anew(const Job& job) {
  Keeper::Begun begun{{make_frame(job)}, {}};
  begun.work = begun.frame.frame->begin();
  return begun;
}

}  // namespace

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
  own.finished = [&](std::size_t frame, JobReport report) {
    if (watcher.finished) watcher.finished(frame, report);
    ended = std::move(report);
  };
  run(Shot{{job}}, own);
  return ended;
}

void Coordinator::run(const Shot& shot, const JobWatcher& watcher) {
  const ShotId id = begin(shot, {}, watcher);
  while (!over(id)) turn(clock_now() + kLongestSleep);
}

ShotId Coordinator::begin(Shot shot, const Standing& standing, JobWatcher watcher, Keeper* keeper) {
  validate(shot);
  const Instant now = clock_now();
  const ShotId id = next_shot_++;
  runs_.emplace(id, Run{ShotPlan(std::move(shot)), standing, std::move(watcher), keeper, now, now});
  begin_frames(now);
  return id;
}

void Coordinator::turn(Instant until) {
  std::optional<Mail> mail = road_.receive(std::min(until, next_wake(clock_now())));
  const Instant now = clock_now();
  for (int n = 0; mail; ++n) {
    hear(std::move(*mail), now);
    if (n == kMailsATurn) break;
    mail = road_.receive(now);
  }
  if (!mail) tell(TimePassed{}, now);
  for (auto& [id, active] : active_) advance(active, now);
  const bool one_ended = std::ranges::any_of(active_, [](const auto& a) { return a.second.over(); });
  show(now, one_ended);
  if (one_ended) end_frames(now);
  if (interrupted_) begin_frames(now);
  end_runs();
  answer_held(now);
}

// Watchers hear how far their shots are, and of snapshots.
void Coordinator::show(Instant now, bool one_ended) {
  for (auto& [id, run] : runs_) {
    if (!run.watcher.progress || (now < run.next_progress && !one_ended)) continue;
    run.watcher.progress(progress(id, run, now));
    run.next_progress = now + run.watcher.interval;
  }
  if (!snapshot_wanted_.exchange(false)) return;
  for (const auto& [id, active] : active_)
    if (const auto& snapshot = run_of(active).watcher.snapshot) snapshot(active.place, report(active, now));
}

void Coordinator::begin_frames(Instant now) {
  for (auto& [id, run] : runs_) {
    if (interrupted_) run.plan.stop();
    if (run.paused) continue;
    while (const auto start = run.plan.start()) begin_frame(id, run, *start, now);
  }
}

void Coordinator::begin_frame(ShotId shot, Run& run, const ShotPlan::Start& start, Instant now) {
  const Job& job = run.plan.frames()[start.frame];
  Keeper::Begun begun = run.keeper ? run.keeper->begin(start.frame, job) : begin_anew(job);
  const JobId id = next_job_++;
  Active& active = active_
                       .try_emplace(id, Active{.id = id,
                                               .shot = shot,
                                               .place = start.frame,
                                               .started = before(now, begun.frame.seconds),
                                               .state = std::move(begun.frame)})
                       .first->second;
  if (begun.failure) {
    active.failure = std::move(begun.failure);
    active.bad_input = true;
    return;
  }
  if (!start.awaits_history && active.frame().awaits_history()) remember(active, start.history, now);
  add(active, begun.work, now);
}

void Coordinator::end_frames(Instant now) {
  for (auto it = active_.begin(); it != active_.end();) {
    if (!it->second.over()) {
      ++it;
      continue;
    }
    auto ended = active_.extract(it++);
    dismiss(ended.mapped(), now);
    hand_on(std::move(ended.mapped()), now);
  }
  begin_frames(now);
}

void Coordinator::end_runs() {
  for (auto it = runs_.begin(); it != runs_.end();) {
    const auto& [id, run] = *it;
    const bool over = run.plan.over();
    if (over && run.watcher.progress && run.plan.frames().size() > 1)
      run.watcher.progress(progress(id, run, clock_now()));
    it = over ? runs_.erase(it) : std::next(it);
  }
}

// What the frame kept goes to the next one, before anybody is told: workers are not to wait for that.
void Coordinator::hand_on(Active ended, Instant now) {
  JobReport report = Coordinator::report(std::move(ended), now);
  Run& run = runs_.at(ended.shot);
  if (const auto next = run.plan.end(ended.place, report.kept))
    for (auto& [id, active] : active_)
      if (active.shot == ended.shot && active.place == *next && active.frame().awaits_history())
        remember(active, report.kept, now);
  if (run.watcher.finished) run.watcher.finished(ended.place, std::move(report));
}

void Coordinator::remember(Active& active, const std::shared_ptr<const Image>& history, Instant now) {
  if (Keeper* keeper = run_of(active).keeper) keeper->remembers(active.place, history);
  add(active, active.frame().remember(history), now);
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

void Coordinator::interrupt(ShotId shot) {
  runs_.at(shot).plan.stop();
  for (auto& [id, active] : active_)
    if (active.shot == shot) active.interrupted = true;
}

void Coordinator::drop(ShotId shot) {
  const Instant now = clock_now();
  for (auto it = active_.begin(); it != active_.end();) {
    if (it->second.shot != shot) {
      ++it;
      continue;
    }
    const auto dropped = active_.extract(it++);
    dismiss(dropped.mapped(), now);
  }
  runs_.erase(shot);
}

void Coordinator::pause(ShotId shot) {
  if (over(shot)) return;
  runs_.at(shot).paused = true;
  for (const auto& [id, active] : active_)
    if (active.shot == shot) tell(PausedJob{id}, clock_now());
}

void Coordinator::resume(ShotId shot) {
  if (over(shot)) return;
  runs_.at(shot).paused = false;
  for (const auto& [id, active] : active_)
    if (active.shot == shot) tell(ResumedJob{id}, clock_now());
  begin_frames(clock_now());
}

void Coordinator::set_standing(ShotId shot, const Standing& standing) {
  runs_.at(shot).standing = standing;
  for (const auto& [id, active] : active_)
    if (active.shot == shot) tell(Reranked{id, standing_of(active)}, clock_now());
}

void Coordinator::release(const std::string& worker) {
  spdlog::info("coordinator: worker {} is released", worker);
  tell(Released{worker}, clock_now());
}

Instant Coordinator::next_wake(Instant now) const {
  Instant wake = now + kLongestSleep;
  if (const auto deadline = scheduler_.next_deadline()) wake = std::min(wake, *deadline);
  if (const auto answer = held_.next(now)) wake = std::min(wake, *answer);
  return std::max(wake, now);
}

// Earlier frames first, whatever the order in which their tasks become known.
Standing Coordinator::standing_of(const Active& active) const {
  Standing standing = runs_.at(active.shot).standing;
  standing.rank += active.place;
  return standing;
}

void Coordinator::add(Active& active, const std::vector<Work>& work, Instant now) {
  if (work.empty()) return;
  Submitted submitted{{}, standing_of(active)};
  for (const Work& w : work) {
    const TaskId id = next_task_++;
    tasks_.emplace(id, Task{id, active.id, w});
    submitted.tasks.push_back(wish_of(active, id, w));
  }
  tell(submitted, now);
}

void Coordinator::advance(Active& a, Instant now) {
  const AcceptanceRule& rule = a.frame().job().acceptance;
  const double seconds = seconds_between(a.started, now);
  if (const std::lock_guard lock(failing_); failure_) a.failure = failure_;
  if (a.over()) return;
  if (interrupted_ || a.interrupted) return a.frame().stop(StopReason::interrupted);
  if (rule.max_seconds && seconds >= *rule.max_seconds && a.frame().seen())
    return a.frame().stop(StopReason::max_seconds);
  if (!a.frame().round_complete()) return;
  const std::vector<Work> next = a.frame().look({seconds});
  if (const auto error = a.frame().progress(seconds).error)
    a.state.errors.push_back(static_cast<float>(*error));
  if (a.frame().stopped()) return;
  if (Keeper* keeper = run_of(a).keeper) keeper->looked(a.place, a.state, seconds);
  add(a, next, now);
}

// The job is over: nobody need work on it any more.
void Coordinator::dismiss(const Active& active, Instant now) {
  std::erase_if(tasks_, [&](const auto& t) { return t.second.job == active.id; });
  tell(WithdrawnJob{active.id}, now);
  for (const WorkerId& worker : active.offered) road_.send(worker, JobOver{active.id});
}

}  // namespace tessera
