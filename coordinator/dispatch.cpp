// SPDX-License-Identifier: Apache-2.0
// How the scheduler gives tasks out: whose turn it is to get one, and which one it gets.
#include <algorithm>

#include "coordinator/scheduler.h"

namespace tessera {
namespace {

// How many tasks are looked at for one that this worker may take over; others take those passed over.
constexpr int kWindow = 32;

}  // namespace

// Idle slots first, over all workers, then what they take ahead.
void Scheduler::dispatch() {
  turns_.clear();
  for (auto& [name, kind] : roster_.classes())
    if (!kind.roomy.empty()) turns_.push_back({&kind, kind.roomy.begin()->first});
  while (!turns_.empty()) {
    const auto turn = std::ranges::min_element(turns_, {}, &Turn::next);
    auto& roomy = turn->kind->roomy;
    auto it = roomy.lower_bound(turn->next);
    if (it != roomy.end()) {
      const book::Room room = it->first;
      Worker& worker = *it->second;
      const bool go_on = serve(worker) != Served::nothing || others_might_find(worker);
      it = go_on ? roomy.upper_bound(room) : roomy.end();
    }
    if (it != roomy.end())
      turn->next = it->first;
    else
      turns_.erase(turn);
  }
}

// Gives the worker a task, if there is one for it.
Scheduler::Served Scheduler::serve(Worker& worker) {
  if (roster_.on_trial(worker)) return Served::not_now;
  Task* task = ledger_.waiting().first_for(worker);
  if (!task && options_.endgame && worker.idle()) task = take_over_for(worker);
  if (!task) return Served::nothing;
  if (!ledger_.fits(*task, worker)) return Served::not_now;
  const Attempt attempt = task->attempts + 1;
  if (task->scene && worker.scenes.front() != task->scene) {
    worker.scenes.back() = worker.scenes.front();
    worker.scenes.front() = task->scene;
  }
  entrust(*task, worker, attempt);
  out_.push_back(AssignTask{worker.id, task->id, attempt});
  ++counts_.assigned;
  return Served::yes;
}

// What an idle slot may do for others.
Scheduler::Task* Scheduler::take_over_for(const Worker& worker) {
  Task* task = queued_elsewhere(worker);
  if (task) {
    take_over(*task);
  } else {
    task = double_for(worker);
    if (task) ++counts_.doubled;
  }
  return task;
}

// Where this worker of the class, than which the others are no less full, found nothing.
bool Scheduler::others_might_find(const Worker& worker) const {
  if (ledger_.waiting().special(*worker.device_class)) return true;
  const bool lone =
      !ledger_.burdened().empty() || !ledger_.lone().empty() || !worker.device_class->lone.empty();
  return options_.endgame && worker.idle() && lone;
}

bool Scheduler::may_have(const Worker& worker, const Task& task) const {
  return roster_.may_have(worker, terms_of(task));
}

// A task that lies in the longest queue, at its end: its holder would come to it last.
Scheduler::Task* Scheduler::queued_elsewhere(const Worker& worker) {
  int looked = 0;
  for (const auto& [burden, holder] : ledger_.burdened())
    for (auto it = holder->queued.rbegin(); it != holder->queued.rend(); ++it) {
      if (++looked > kWindow) return nullptr;
      Task& task = *it->second;
      if (task.leases.size() == 1 && may_have(worker, task)) return &task;
    }
  return nullptr;
}

// Its holder has not begun it: it is told to drop it. If that word is lost, two work on it, at worst.
void Scheduler::take_over(Task& task) {
  const book::Lease& lease = *task.leases.begin();
  task.moved_from = lease.worker->number;
  task.moved_attempt = lease.attempt;
  ++counts_.moved;
  revoke(task, *lease.worker);
}

// Somebody else's task, that which is at work the longest.
Scheduler::Task* Scheduler::double_for(const Worker& worker) {
  Task* oldest = nullptr;
  const book::LoneTasks& of_class = worker.device_class->lone;
  for (const book::LoneTasks* lone : {&ledger_.lone(), &of_class}) {
    int looked = 0;
    for (const auto& [since, task] : *lone) {
      if (++looked > worker.slots + kWindow) break;
      if (task->leases.of(worker) || !may_have(worker, *task)) continue;
      if (!oldest || task->leases.begin()->since < oldest->leases.begin()->since) oldest = task;
      break;
    }
  }
  return oldest;
}

// The first filter task of a job that is given out decides on which class does the others.
void Scheduler::entrust(Task& task, Worker& worker, Attempt attempt) {
  if (task.filter && !class_for(task)) {
    const std::optional<std::string> last = task.job->last_class;
    ledger_.choose_class(*task.job, worker.device_class);
    if (last != task.job->last_class)
      out_.push_back(ClassChanged{task.job->id, last.value_or(""), *task.job->last_class});
  }
  if (worker.held() == 0) roster_.prompt(worker);
  ledger_.lend(task, worker, attempt, now_);
}

}  // namespace tessera
