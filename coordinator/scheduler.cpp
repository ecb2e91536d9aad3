// SPDX-License-Identifier: Apache-2.0
// What the scheduler makes of its news. How tasks are given out: dispatch.cpp; what failures lead to:
// blame.cpp.
#include "coordinator/scheduler.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace tessera {
namespace {

constexpr double kMemory = 0.25;  // what a worker's last task weighs in its speed

void smooth(double& value, double sample) { value += (value == 0 ? 1 : kMemory) * (sample - value); }

}  // namespace

std::vector<Command> Scheduler::handle(const Event& event, Instant now) {
  now_ = std::max(now_, now);
  roster_.set_time(now_);
  std::visit([this](const auto& e) { on(e); }, event);
  dispatch();
  return std::exchange(out_, {});
}

std::optional<Instant> Scheduler::next_deadline() const { return roster_.next_deadline(); }

SchedulerCounts Scheduler::counts() const {
  SchedulerCounts counts = counts_;
  counts.workers = roster_.present();
  counts.set_aside = roster_.set_aside();
  counts.running = ledger_.running();
  counts.waiting = ledger_.tasks() - ledger_.running();
  return counts;
}

std::vector<WorkerFigures> Scheduler::workers() const {
  std::vector<WorkerFigures> all;
  for (const auto& [id, w] : roster_.workers())
    if (!w.gone)
      all.push_back({id, w.name->name, w.device_class->name, w.slots, w.held(), w.done, w.failed,
                     w.pace > 0 ? w.slots / w.pace : 0, w.name->set_aside});
  std::ranges::sort(all, {}, &WorkerFigures::worker);
  return all;
}

// --- Workers come, speak and go. ---

void Scheduler::on(const Joined& e) {
  Worker* known = roster_.worker(e.worker);
  if (known && known->gone) return;
  if (known && !roster_.same(*known, e)) {  // another one under the same id
    dismiss(*known);
    forget(*known);
  }
  Worker& worker = roster_.join(e);
  ledger_.settle(worker, now_);
  if (!worker.able()) out_.push_back(SetAside{worker.id, worker.name->name, worker.name->set_aside});
}

void Scheduler::on(const Heard& e) {
  Worker* worker = listen(e.worker);
  if (worker && e.held) compare(*worker, *e.held);
}

void Scheduler::on(const Left& e) {
  Worker* worker = roster_.worker(e.worker);
  if (!worker || worker->gone) return;
  roster_.hear(*worker);
  release_all(*worker, false);
  ledger_.shut(*worker);
  roster_.retire(*worker);
  gave_up_class(*worker->device_class);
}

void Scheduler::on(const Released& e) {
  Name* name = roster_.name(e.worker);
  if (!name) return;
  roster_.release(*name);
  for (Worker* worker : name->workers) ledger_.settle(*worker, now_);
}

void Scheduler::on(const TimePassed&) {
  while (Worker* w = roster_.overdue()) {
    if (!w->gone) {
      out_.push_back(Forget{w->id});
      release_all(*w, true);
    }
    forget(*w);
  }
}

void Scheduler::forget(Worker& worker) {
  DeviceClass& kind =
      roster_.use_class(std::string(worker.device_class->name));  // it outlives its last worker
  ledger_.shut(worker);
  roster_.forget(worker);
  gave_up_class(kind);
  roster_.drop_class(kind);
}

// The worker, if it is one of ours; strangers are asked to introduce themselves.
Scheduler::Worker* Scheduler::listen(const WorkerId& id) {
  Worker* worker = roster_.worker(id);
  if (!worker) out_.push_back(AskHello{id});
  if (!worker || worker->gone) return nullptr;
  roster_.hear(*worker);
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
    for (const auto& [order, task] : *tasks)
      if (!has.contains(task->id) && now_ - task->leases.of(worker)->seen > options_.grace)
        lost.push_back(task);
  for (Task* task : lost) release(*task, worker);
}

void Scheduler::reported(Worker& worker, const Held& held) {
  Task* task = ledger_.task(held.task);
  if (book::Lease* lease = task ? task->leases.of(worker) : nullptr) {
    lease->seen = now_;
    return;
  }
  // It was thought lost, but is not: better to let it finish than to begin again. But not where it was taken
  // out of the queue, by a word that is still under way.
  const auto welcome = [&] {
    if (!task || task->leases.full() || !worker.able()) return false;
    if (task->moved_from == worker.number && held.attempt <= task->moved_attempt && !task->leases.empty())
      return false;
    const auto failed = std::ranges::find(task->failures, worker.name->name, &book::Failure::name);
    return failed == task->failures.end() && may_have(worker, *task);
  };
  if (welcome())
    entrust(*task, worker, held.attempt);
  else
    out_.push_back(RevokeTask{worker.id, held.task, held.attempt});
}

// --- Tasks end. ---

void Scheduler::on(const Done& e) {
  Worker* worker = listen(e.worker);
  Task* task = ledger_.task(e.task);
  Worker* sender = roster_.worker(e.worker);  // gone, perhaps
  if (!task || !may_answer(*task, e.worker, sender)) {
    ++counts_.dropped;
    return;
  }
  if (task->filter && !class_for(*task)) ledger_.choose_class(*task->job, sender->device_class);
  out_.push_back(Accept{e.task});
  ++counts_.accepted;
  if (worker) {
    ++worker->done;
    roster_.succeeded(*worker->name);
    learn(*worker, *task, e.seconds);
    if (task->leases.of(*worker)) ledger_.take_back(*task, *worker, now_);
  }
  revoke_all(*task);
  const std::vector<book::Failure> failures = std::move(task->failures);
  erase(*task);
  convict(failures, sender ? sender->name : nullptr);
}

// Where bits may differ between classes, or are to be compared, it matters whose they are.
bool Scheduler::may_answer(const Task& task, const WorkerId& id, const Worker* sender) const {
  if (!task.avoid.empty() && (task.avoid == id || !sender || task.avoid == sender->name->name)) return false;
  const DeviceClass* kind = class_for(task);
  if (!kind && !task.filter) return true;
  return sender && !sender->gone && (!kind || kind == sender->device_class);
}

// What a worker says of itself is believed within the time that passed.
void Scheduler::learn(Worker& worker, const Task& task, double seconds) {
  const auto lease = std::ranges::find(task.leases, &worker, &book::Lease::worker);
  if (lease == task.leases.end() || !(seconds > 0)) return;
  const double passed = seconds_between(lease->given, now_);
  const double sane = std::min(seconds, passed);
  if (sane <= 0) return;
  smooth(worker.rate[task.filter], sane / task.cost);
  smooth(worker.pace, sane);
}

void Scheduler::on(const Failed& e) {
  Worker* worker = listen(e.worker);
  Task* task = ledger_.task(e.task);
  if (!task) return;
  if (e.bad_input) return give_up(*task, e.reason, true);
  if (!worker) return;
  const book::Lease* lease = task->leases.of(*worker);
  if (!lease || lease->attempt != e.attempt) return;  // it was counted already
  ++worker->failed;
  strike(*task, *worker, e.reason, ++incidents_);
  release(*task, *worker);
}

void Scheduler::revoke(Task& task, Worker& worker) {
  out_.push_back(RevokeTask{worker.id, task.id, task.leases.of(worker)->attempt});
  ++counts_.revoked;
  ledger_.take_back(task, worker, now_);
}

void Scheduler::revoke_all(Task& task) {
  while (!task.leases.empty()) revoke(task, *std::prev(task.leases.end())->worker);
}

void Scheduler::give_up(Task& task, const std::string& reason, bool bad_input) {
  out_.push_back(GiveUp{task.id, reason, bad_input});
  ++counts_.given_up;
  revoke_all(task);
  erase(task);
}

void Scheduler::erase(Task& task) {
  Job& job = *task.job;
  ledger_.erase(task);
  ledger_.forget_if_idle(job);
}

// --- Work comes and goes. ---

void Scheduler::on(const Submitted& e) {
  for (const Wish& wish : e.tasks) {
    Job& job = ledger_.job(wish.job);
    ledger_.rerank(job, e.standing);
    ledger_.add(wish, job);
  }
}

void Scheduler::on(const Reranked& e) {
  if (Job* job = ledger_.find_job(e.job)) ledger_.rerank(*job, e.standing);
}

void Scheduler::on(const PausedJob& e) { ledger_.pause(ledger_.job(e.job), true); }

void Scheduler::on(const ResumedJob& e) {
  Job* job = ledger_.find_job(e.job);
  if (!job) return;
  ledger_.pause(*job, false);
  ledger_.forget_if_idle(*job);
}

void Scheduler::on(const WithdrawnTasks& e) {
  for (const TaskId id : e.tasks)
    if (Task* task = ledger_.task(id)) {
      revoke_all(*task);
      erase(*task);
    }
}

void Scheduler::on(const WithdrawnJob& e) {
  Job* job = ledger_.find_job(e.job);
  if (!job) return;
  while (!job->tasks.empty()) {
    revoke_all(job->tasks.front());
    ledger_.erase(job->tasks.front());
  }
  ledger_.erase(*job);
}

}  // namespace tessera
