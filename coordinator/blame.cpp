// SPDX-License-Identifier: Apache-2.0
// What failures lead to: who is to blame, the task or the worker, and what becomes of both.
#include <algorithm>
#include <utility>

#include "coordinator/scheduler.h"

namespace tessera {

void Scheduler::strike(Task& task, Worker& worker, const std::string& reason, std::uint64_t incident) {
  Name& name = *worker.name;
  ++task.strikes;
  task.reason = reason;
  task.witnessed |= name.tried;
  roster_.failed(name, reason, incident);
  const auto place = std::ranges::lower_bound(task.failures, name.name, {}, &book::Failure::name);
  if (place == task.failures.end() || place->name != name.name)
    task.failures.insert(place, {name.name, incident});
}

// Workers enough have failed at it, one of which can do others.
bool Scheduler::poisonous(const Task& task) const {
  return task.witnessed && static_cast<int>(task.failures.size()) >= options_.max_attempts;
}

// Or there is no other worker.
bool Scheduler::hopeless(const Task& task) const {
  const int most = options_.max_attempts;
  if (task.strikes < most) return false;
  constexpr int kPatience = 3;  // workers none of which ever did anything prove little
  return task.strikes >= kPatience * std::int64_t(most) || !roster_.anybody_else(terms_of(task));
}

// If the only workers of a class are broken, others can still filter the frame.
bool Scheduler::try_another_class(Task& task) {
  Job& job = *task.job;
  DeviceClass* old = job.filter_class;
  book::Terms terms = terms_of(task);
  if (!task.filter || task.only || !old ||
      task.strikes < std::min(book::kClassAttempts, options_.max_attempts) || roster_.anybody_else(terms))
    return false;
  job.spoiled.insert(old->name);
  for (auto& [name, kind] : roster_.classes()) {
    terms.device_class = &kind;
    if (job.spoiled.contains(name) || !roster_.anybody_else(terms)) continue;
    for (Task& other : job.tasks)
      if (other.filter && !other.only && !other.leases.empty()) {
        revoke_all(other);
        ledger_.wait(other);
      }
    out_.push_back(ClassChanged{job.id, old->name, name});
    ledger_.choose_class(job, &kind);
    task.strikes = 0;
    return true;
  }
  return false;
}

// The worker has it no more. If nobody has, it waits again, unless it had chances enough.
void Scheduler::release(Task& task, Worker& worker) {
  if (!task.leases.of(worker)) return;
  ledger_.take_back(task, worker, now_);
  if (!task.leases.empty()) return;
  if (poisonous(task) || (!try_another_class(task) && hopeless(task)))
    return give_up(task, task.reason, false);
  ++counts_.retried;
  ledger_.wait(task);
}

// A task that a worker was at when it died may be what killed it; those that lay in its queue are innocent.
void Scheduler::release_all(Worker& worker, bool dead) {
  const auto running = worker.running, queued = worker.queued;
  ++incidents_;
  for (const auto& [order, task] : running) {
    if (!dead) break;
    strike(*task, worker, "worker " + worker.id + " fell silent while at it", incidents_);
    task->witnessed = true;  // to end workers takes more than to fail on them
  }
  // The queue first, else its tasks would be taken for running ones as slots become free.
  for (const auto* tasks : {&queued, &running})
    for (const auto& [order, task] : *tasks) release(*task, worker);
}

// It is told to drop all that it has, which others get; without blame.
void Scheduler::dismiss(Worker& worker) {
  for (const auto* tasks : {&worker.running, &worker.queued})
    for (const auto& [order, task] : *tasks) {
      out_.push_back(RevokeTask{worker.id, task->id, task->leases.of(worker)->attempt});
      ++counts_.revoked;
    }
  release_all(worker, false);
}

// Others did what failed on these.
void Scheduler::convict(const std::vector<book::Failure>& failures, const Name* but) {
  for (const book::Failure& f : failures) {
    Name* name = roster_.name(f.name);
    if (name && name != but && roster_.convict(*name, f.incident)) set_aside(*name);
  }
}

void Scheduler::set_aside(Name& name) {
  const std::string why = "it failed " + std::to_string(name.proven.size()) +
                          " times in a row at what others can do; last: " + name.last_failure;
  for (Worker* worker : name.workers) dismiss(*worker);
  roster_.set_aside(name, why);
  for (Worker* worker : name.workers) {
    ledger_.shut(*worker);
    out_.push_back(SetAside{worker->id, name.name, why});
    gave_up_class(*worker->device_class);
  }
}

// If nobody of the class is left, others do its filter tasks.
void Scheduler::gave_up_class(DeviceClass& kind) {
  if (!kind.able.empty()) return;
  while (!kind.jobs.empty()) ledger_.choose_class(*kind.jobs.begin()->second, nullptr);
}

}  // namespace tessera
