// SPDX-License-Identifier: Apache-2.0
#include "coordinator/scheduler.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace tessera {
namespace {

// How many tasks are looked at for one that this worker may have; those passed over have failed on it, and
// others will take them.
constexpr int kWindow = 32;

}  // namespace

std::vector<Command> Scheduler::handle(const Event& event, Instant now) {
  now_ = std::max(now_, now);
  std::visit([this](const auto& e) { on(e); }, event);
  dispatch();
  return std::exchange(out_, {});
}

std::optional<Instant> Scheduler::next_deadline() const {
  const Worker* quietest = ledger_.quietest();
  if (!quietest) return std::nullopt;
  return quietest->last_word + options_.silence;
}

void Scheduler::on(const Joined& e) {
  const Worker* worker = ledger_.worker(e.worker);
  if (worker && worker->gone) return;
  ledger_.join(e.worker, e.slots, now_);
}

void Scheduler::on(const Heard& e) {
  Worker* worker = listen(e.worker);
  if (worker && e.held) compare(*worker, *e.held);
}

void Scheduler::on(const Done& e) {
  listen(e.worker);
  Task* task = ledger_.task(e.task);
  if (!task) return;
  out_.push_back(Accept{e.task});
  if (Worker* worker = ledger_.worker(e.worker); worker && task->lent_to(*worker))
    ledger_.take_back(*task, *worker, now_);
  revoke_all(*task);
  ledger_.erase(*task);
}

void Scheduler::on(const Failed& e) {
  Worker* worker = listen(e.worker);
  Task* task = ledger_.task(e.task);
  if (!task) return;
  if (e.bad_input) return give_up(*task, e.reason, true);
  if (!worker) return;
  const auto lease = std::ranges::find(task->leases, worker, &Ledger::Lease::worker);
  if (lease == task->leases.end() || lease->attempt != e.attempt) return;  // it was counted already
  strike(*task, e.worker, e.reason);
  release(*task, *worker);
}

void Scheduler::on(const Left& e) {
  Worker* worker = ledger_.worker(e.worker);
  if (!worker || worker->gone) return;
  ledger_.hear(*worker, now_);
  release_all(*worker, false);
  ledger_.retire(*worker);
}

void Scheduler::on(const Submitted& e) {
  for (const Wish& wish : e.tasks) ledger_.add(wish.task, wish.job, e.standing.rank);
}

void Scheduler::on(const WithdrawnTasks& e) {
  for (const TaskId id : e.tasks)
    if (Task* task = ledger_.task(id)) {
      revoke_all(*task);
      ledger_.erase(*task);
    }
}

void Scheduler::on(const WithdrawnJob& e) { on(WithdrawnTasks{ledger_.tasks_of(e.job)}); }

void Scheduler::on(const TimePassed&) {
  for (Worker* w = ledger_.quietest(); w && w->last_word + options_.silence <= now_; w = ledger_.quietest()) {
    if (!w->gone) {
      out_.push_back(Forget{w->id});
      release_all(*w, true);
    }
    ledger_.forget(*w);
  }
}

// The worker, if it is one of ours; strangers are asked to introduce themselves.
Scheduler::Worker* Scheduler::listen(const WorkerId& id) {
  Worker* worker = ledger_.worker(id);
  if (!worker) out_.push_back(AskHello{id});
  if (!worker || worker->gone) return nullptr;
  ledger_.hear(*worker, now_);
  return worker;
}

// Makes good what was lost on the way: tasks it should hold but does not (an Assign or a result was lost),
// and tasks it holds but should not (a Revoke was lost).
void Scheduler::compare(Worker& worker, const std::vector<Held>& held) {
  std::unordered_set<TaskId> has;
  for (const Held& h : held)
    if (has.insert(h.task).second) reported(worker, h);
  std::vector<Task*> lost;
  for (const auto* tasks : {&worker.running, &worker.queued})
    for (const auto& [order, task] : *tasks) {
      const auto lease = std::ranges::find(task->leases, &worker, &Ledger::Lease::worker);
      if (!has.contains(task->id) && now_ - lease->seen > options_.grace) lost.push_back(task);
    }
  for (Task* task : lost) release(*task, worker);
}

void Scheduler::reported(Worker& worker, const Held& held) {
  Task* task = ledger_.task(held.task);
  const bool lent = task && task->lent_to(worker);
  if (lent) {
    std::ranges::find(task->leases, &worker, &Ledger::Lease::worker)->seen = now_;
    return;
  }
  // It was thought lost, but is not: better to let it finish than to begin again.
  const bool welcome = task && task->leases.size() < 2 &&
                       std::ranges::find(task->failed_on, worker.id) == task->failed_on.end();
  if (welcome)
    ledger_.lend(*task, worker, held.attempt, now_);
  else
    out_.push_back(RevokeTask{worker.id, held.task, held.attempt});
}

void Scheduler::strike(Task& task, const WorkerId& worker, const std::string& reason) {
  ++task.strikes;
  task.reason = reason;
  if (std::ranges::find(task.failed_on, worker) == task.failed_on.end()) task.failed_on.push_back(worker);
}

// The worker has it no more. If nobody has, it waits again, unless it had chances enough.
void Scheduler::release(Task& task, Worker& worker) {
  ledger_.take_back(task, worker, now_);
  if (!task.leases.empty()) return;
  if (task.strikes >= options_.max_attempts)
    give_up(task, task.reason, false);
  else
    ledger_.wait(task);
}

// A task that a worker was at when it died may be what killed it; those that lay in its queue are innocent.
void Scheduler::release_all(Worker& worker, bool dead) {
  const Ledger::WaitingTasks running = worker.running, queued = worker.queued;
  for (const auto& [order, task] : running)
    if (dead) strike(*task, worker.id, "worker " + worker.id + " fell silent while at it");
  // The queue first, else its tasks would be taken for running ones as slots become free.
  for (const auto* tasks : {&queued, &running})
    for (const auto& [order, task] : *tasks) release(*task, worker);
}

void Scheduler::revoke_all(Task& task) {
  while (!task.leases.empty()) {
    const Ledger::Lease lease = task.leases.back();
    out_.push_back(RevokeTask{lease.worker->id, task.id, lease.attempt});
    ledger_.take_back(task, *lease.worker, now_);
  }
}

void Scheduler::give_up(Task& task, const std::string& reason, bool bad_input) {
  out_.push_back(GiveUp{task.id, reason, bad_input});
  revoke_all(task);
  ledger_.erase(task);
}

// Idle slots first, over all workers, then what they take ahead.
void Scheduler::dispatch() {
  const auto& roomy = ledger_.roomy();
  for (auto it = roomy.begin(); it != roomy.end();) {
    Worker& worker = *it->second;
    if (nothing_to_give(worker)) return;
    const Ledger::Room room = it->first;
    Task* task = next_for(worker);
    if (!task && worker.idle()) task = double_for(worker);
    if (task) {
      out_.push_back(AssignTask{worker.id, task->id, task->attempts + 1});
      ledger_.lend(*task, worker, task->attempts + 1, now_);
    }
    it = roomy.upper_bound(room);
  }
}

// Those after `next` are at least as full.
bool Scheduler::nothing_to_give(const Worker& next) const {
  if (!ledger_.fresh().empty() || !ledger_.retried().empty()) return false;
  const bool lone = !ledger_.lone_queued().empty() || !ledger_.lone_running().empty();
  return !(options_.endgame && lone && next.idle());
}

// Not where it failed before, unless it failed on everybody.
bool Scheduler::may_try(const Task& task, const Worker& worker) {
  if (std::ranges::find(task.failed_on, worker.id) == task.failed_on.end()) return true;
  const auto present = [this](const WorkerId& id) {
    const Worker* w = ledger_.worker(id);
    return w && !w->gone;
  };
  return static_cast<std::size_t>(std::ranges::count_if(task.failed_on, present)) == ledger_.present();
}

Scheduler::Task* Scheduler::next_for(const Worker& worker) {
  Task* next = ledger_.fresh().empty() ? nullptr : ledger_.fresh().begin()->second;
  int looked = 0;
  for (const auto& [wish, task] : ledger_.retried()) {
    if ((next && next->wish < wish) || ++looked > kWindow) break;
    if (may_try(*task, worker)) return task;
  }
  return next;
}

// Somebody else's task: one that only lies in a queue, else the one that is at work the longest. Not one that
// had chances enough: it would never be without a copy, and never be given up.
Scheduler::Task* Scheduler::double_for(const Worker& worker) {
  if (!options_.endgame) return nullptr;
  for (const auto* tasks : {&ledger_.lone_queued(), &ledger_.lone_running()}) {
    int looked = 0;
    for (const auto& [since, task] : *tasks) {
      if (++looked > worker.slots + kWindow) break;
      const bool chances = task->strikes < options_.max_attempts;
      if (chances && !task->lent_to(worker) && may_try(*task, worker)) return task;
    }
  }
  return nullptr;
}

}  // namespace tessera
