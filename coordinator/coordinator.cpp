// SPDX-License-Identifier: Apache-2.0
#include "coordinator/coordinator.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <type_traits>
#include <unordered_map>

#include "proto/clock.h"

namespace tessera {
namespace {

constexpr Millis kLongestSleep{1000};  // so that progress is shown while nothing is heard

double seconds_between(Instant from, Instant to) { return std::chrono::duration<double>(to - from).count(); }

}  // namespace

struct Coordinator::Active {
  Active(JobId job_id, const Job& job, Instant now) : id(job_id), started(now), frame(job) {}

  JobId id;
  Instant started;
  Frame frame;
  std::unordered_map<TaskId, Task> tasks;                          // not accepted yet
  std::set<WorkerId> offered;                                      // workers that were told of the job
  std::variant<std::monostate, RenderDone*, FilterDone*> in_hand;  // the result being decided on
  WorkerId in_hand_from;
  std::uint64_t dropped = 0;
  std::set<std::string> device_classes;
  std::optional<std::string> failure;
  bool bad_input = false;

  bool over() const { return failure.has_value() || frame.stopped(); }
};

Coordinator::Coordinator(Transport& road, const CoordinatorOptions& options)
    : road_(road),
      options_(options),
      scheduler_(options.scheduler),
      next_job_(options.first_id),
      next_task_(options.first_id) {}

Coordinator::~Coordinator() = default;

JobReport Coordinator::run(const Job& job, const JobWatcher& watcher) {
  validate(job);
  const Instant start = clock_now();
  active_ = std::make_unique<Active>(next_job_++, job, start);
  add(active_->frame.begin(), start);
  Instant next_progress = start;
  while (!active_->over()) {
    std::optional<Mail> mail = road_.receive(next_wake(clock_now()));
    const Instant now = clock_now();
    if (mail)
      hear(std::move(*mail), now);
    else
      tell(TimePassed{}, now);
    advance(now);
    if (watcher.progress && (now >= next_progress || active_->over())) {
      watcher.progress(active_->frame.progress(seconds_between(start, now)));
      next_progress = now + watcher.interval;
    }
    if (snapshot_wanted_.exchange(false) && watcher.snapshot) watcher.snapshot(report(now));
  }
  const Instant end = clock_now();
  dismiss(end);
  JobReport ended = report(end);
  active_.reset();
  return ended;
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

void Coordinator::hear(Mail mail, Instant now) {
  std::visit(
      [&](auto& message) {
        using Kind = std::decay_t<decltype(message)>;
        if constexpr (std::is_same_v<Kind, Hello>)
          welcome(mail.from, message, now);
        else if constexpr (std::is_same_v<Kind, Heartbeat>)
          tell(Heard{mail.from, message.held}, now);
        else if constexpr (std::is_same_v<Kind, NeedJob>)
          answer(mail.from, message, now);
        else if constexpr (std::is_same_v<Kind, RenderDone> || std::is_same_v<Kind, FilterDone>)
          take(mail.from, message, now);
        else if constexpr (std::is_same_v<Kind, TaskFailed>)
          tell(Failed{mail.from, message.task, message.attempt, message.reason, message.bad_input}, now);
        else if constexpr (std::is_same_v<Kind, Goodbye>)
          tell(Left{mail.from}, now);
        else
          spdlog::warn("coordinator: {} sent a message that only a coordinator sends", mail.from);
      },
      mail.message);
}

void Coordinator::welcome(const WorkerId& from, const Hello& hello, Instant now) {
  if (hello.protocol != kProtocolVersion) {
    road_.send(from,
               Refused{fmt::format("protocol {} is spoken here, not {}", kProtocolVersion, hello.protocol)});
    return;
  }
  device_classes_[from] = hello.device_class;
  active_->offered.erase(from);
  road_.send(from, Welcome{kProtocolVersion, options_.heartbeat});
  tell(Joined{from, hello.slots}, now);
}

void Coordinator::answer(const WorkerId& from, const NeedJob& need, Instant now) {
  tell(Heard{from}, now);
  if (need.id == active_->id)
    road_.send(from, JobOffer{need.id, active_->frame.job()});
  else
    road_.send(from, JobOver{need.id});
}

bool Coordinator::fits(const RenderDone& result) const {
  const auto task = active_->tasks.find(result.task);
  if (task == active_->tasks.end()) return true;  // an old one: the scheduler drops it
  const auto* work = std::get_if<RenderTask>(&task->second.work);
  return work != nullptr && active_->frame.fits(*work, result.block);
}

bool Coordinator::fits(const FilterDone& result) const {
  const auto task = active_->tasks.find(result.task);
  if (task == active_->tasks.end()) return true;
  const auto* work = std::get_if<FilterTask>(&task->second.work);
  return work != nullptr && active_->frame.fits(*work, result.filtered);
}

template <class Result>
void Coordinator::take(const WorkerId& from, Result& result, Instant now) {
  if (!fits(result)) {
    tell(Failed{from, result.task, result.attempt, "the answer does not fit the task", false}, now);
    return;
  }
  active_->in_hand = &result;
  active_->in_hand_from = from;
  tell(Done{from, result.task, result.attempt}, now);
  active_->in_hand = std::monostate{};
}

void Coordinator::tell(const Event& event, Instant now) {
  for (const Command& command : scheduler_.handle(event, now))
    std::visit([&](const auto& c) { carry_out(c, now); }, command);
}

void Coordinator::carry_out(const AssignTask& c, Instant) {
  const auto found = active_->tasks.find(c.task);
  if (found == active_->tasks.end()) return;
  if (active_->offered.insert(c.worker).second)
    road_.send(c.worker, JobOffer{active_->id, active_->frame.job()});
  Assign assign{found->second, c.attempt, {}};
  if (const auto* filter = std::get_if<FilterTask>(&assign.task.work))
    assign.input = active_->frame.filter_input(*filter);
  road_.send(c.worker, std::move(assign));
}

void Coordinator::carry_out(const RevokeTask& c, Instant) { road_.send(c.worker, Revoke{c.task, c.attempt}); }

void Coordinator::carry_out(const Accept& c, Instant now) {
  const auto node = active_->tasks.extract(c.task);
  if (node.empty()) return;
  active_->device_classes.insert(device_classes_[active_->in_hand_from]);
  if (auto* render = std::get_if<RenderDone*>(&active_->in_hand)) {
    active_->dropped += (*render)->dropped;
    add(active_->frame.fold(std::move((*render)->block)), now);
  } else if (auto* filter = std::get_if<FilterDone*>(&active_->in_hand)) {
    active_->frame.stitch(std::get<FilterTask>(node.mapped().work), (*filter)->filtered);
  }
}

void Coordinator::carry_out(const GiveUp& c, Instant) {
  spdlog::error("coordinator: task {} failed for good: {}", c.task, c.reason);
  active_->failure = c.reason;
  active_->bad_input = c.bad_input;
}

void Coordinator::carry_out(const Forget& c, Instant) {
  spdlog::warn("coordinator: worker {} fell silent; its tasks go to others", c.worker);
  active_->offered.erase(c.worker);
}

void Coordinator::carry_out(const AskHello& c, Instant) { road_.send(c.worker, Unknown{}); }

void Coordinator::add(const std::vector<Work>& work, Instant now) {
  if (work.empty()) return;
  Submitted submitted;
  for (const Work& w : work) {
    const TaskId id = next_task_++;
    active_->tasks.emplace(id, Task{id, active_->id, w});
    submitted.tasks.push_back({id, active_->id});
  }
  tell(submitted, now);
}

void Coordinator::advance(Instant now) {
  Active& a = *active_;
  const AcceptanceRule& rule = a.frame.job().acceptance;
  const double seconds = seconds_between(a.started, now);
  if (const std::lock_guard lock(failing_); failure_) a.failure = failure_;
  if (a.over()) return;
  if (interrupted_) return a.frame.stop(StopReason::interrupted);
  if (rule.max_seconds && seconds >= *rule.max_seconds && a.frame.seen())
    return a.frame.stop(StopReason::max_seconds);
  if (a.frame.round_complete()) add(a.frame.look({seconds}), now);
}

// The job is over: nobody need work on it any more.
void Coordinator::dismiss(Instant now) {
  tell(WithdrawnJob{active_->id}, now);
  for (const WorkerId& worker : active_->offered) road_.send(worker, JobOver{active_->id});
}

JobReport Coordinator::report(Instant now) const {
  const Active& a = *active_;
  return {a.frame.image(), seconds_between(a.started, now), a.dropped, a.device_classes, a.failure,
          a.bad_input};
}

}  // namespace tessera
