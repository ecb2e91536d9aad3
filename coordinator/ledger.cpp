// SPDX-License-Identifier: Apache-2.0
#include "coordinator/ledger.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace tessera {
namespace {

Ledger::Room room_of(const Ledger::Worker& w) { return {w.held() / w.slots, w.held(), w.number}; }

auto lease_of(Ledger::Task& task, const Ledger::Worker& worker) {
  return std::ranges::find(task.leases, &worker, &Ledger::Lease::worker);
}

}  // namespace

bool Ledger::Task::lent_to(const Worker& w) const {
  return std::ranges::find(leases, &w, &Lease::worker) != leases.end();
}

Ledger::Worker* Ledger::worker(const WorkerId& id) {
  const auto it = workers_.find(id);
  return it == workers_.end() ? nullptr : &it->second;
}

Ledger::Task* Ledger::task(TaskId id) {
  const auto it = tasks_.find(id);
  return it == tasks_.end() ? nullptr : &it->second;
}

Ledger::Worker& Ledger::join(const WorkerId& id, int slots, Instant now) {
  assert(slots >= 1);
  const auto [it, fresh] = workers_.try_emplace(id);
  Worker& worker = it->second;
  if (fresh) {
    worker.id = id;
    worker.number = joins_++;
    worker.by_word = by_word_.insert(by_word_.end(), &worker);
  } else {
    unshelve(worker);
  }
  worker.slots = slots;
  hear(worker, now);
  promote(worker, now);
  shelve(worker);
  return worker;
}

void Ledger::hear(Worker& worker, Instant now) {
  worker.last_word = now;
  by_word_.splice(by_word_.end(), by_word_, worker.by_word);
}

void Ledger::retire(Worker& worker) {
  assert(worker.held() == 0 && !worker.gone);
  unshelve(worker);
  worker.gone = true;
  ++retired_;
}

void Ledger::forget(Worker& worker) {
  assert(worker.held() == 0);
  unshelve(worker);
  if (worker.gone) --retired_;
  by_word_.erase(worker.by_word);
  workers_.erase(WorkerId(worker.id));
}

Ledger::Task& Ledger::add(TaskId id, JobId job, std::uint32_t rank) {
  constexpr int kWishBits = 40;  // a trillion tasks
  const auto [it, fresh] = tasks_.try_emplace(id);
  assert(fresh);
  Task& task = it->second;
  task.id = id;
  task.job = job;
  task.wish = (std::uint64_t{rank} << kWishBits) + wishes_++;
  jobs_[job].insert(id);
  wait(task);
  return task;
}

void Ledger::erase(Task& task) {
  assert(task.leases.empty());
  unwait(task);
  const auto job = jobs_.find(task.job);
  job->second.erase(task.id);
  if (job->second.empty()) jobs_.erase(job);
  tasks_.erase(TaskId(task.id));
}

void Ledger::wait(Task& task) {
  assert(task.leases.empty());
  task.waiting = true;
  (task.failed_on.empty() ? fresh_ : retried_).emplace(task.wish, &task);
}

void Ledger::unwait(Task& task) {
  if (!std::exchange(task.waiting, false)) return;
  fresh_.erase(task.wish);
  retried_.erase(task.wish);
}

std::vector<TaskId> Ledger::tasks_of(JobId job) const {
  const auto it = jobs_.find(job);
  if (it == jobs_.end()) return {};
  std::vector<TaskId> tasks(it->second.begin(), it->second.end());
  std::ranges::sort(tasks);
  return tasks;
}

void Ledger::lend(Task& task, Worker& worker, Attempt attempt, Instant now) {
  assert(task.leases.size() < 2 && !task.lent_to(worker) && !worker.gone);
  unwait(task);
  unlist_lone(task);
  unshelve(worker);
  task.attempts = std::max(task.attempts, attempt);
  task.leases.push_back({&worker, attempt, now, now, orders_++});
  worker.queued.emplace(task.leases.back().order, &task);
  list_lone(task);
  promote(worker, now);
  shelve(worker);
}

void Ledger::take_back(Task& task, Worker& worker, Instant now) {
  const auto lease = lease_of(task, worker);
  assert(lease != task.leases.end());
  unlist_lone(task);
  unshelve(worker);
  (lease->running ? worker.running : worker.queued).erase(lease->order);
  task.leases.erase(lease);
  list_lone(task);
  promote(worker, now);
  shelve(worker);
}

// What a free slot takes up next.
void Ledger::promote(Worker& worker, Instant now) {
  while (static_cast<int>(worker.running.size()) < worker.slots && !worker.queued.empty()) {
    auto node = worker.queued.extract(worker.queued.begin());
    Task& task = *node.mapped();
    unlist_lone(task);
    const auto lease = lease_of(task, worker);
    lease->running = true;
    lease->since = now;
    worker.running.insert(std::move(node));
    list_lone(task);
  }
}

void Ledger::list_lone(Task& task) {
  if (task.leases.size() != 1) return;
  const Lease& lease = task.leases.front();
  (lease.running ? lone_running_ : lone_queued_).emplace(std::pair{lease.since, lease.order}, &task);
}

void Ledger::unlist_lone(Task& task) {
  if (task.leases.size() != 1) return;
  const Lease& lease = task.leases.front();
  (lease.running ? lone_running_ : lone_queued_).erase({lease.since, lease.order});
}

void Ledger::shelve(Worker& worker) {
  const std::int64_t most = std::int64_t(worker.slots) * (1 + ahead_);
  if (!worker.gone && worker.held() < most) roomy_.emplace(room_of(worker), &worker);
}

void Ledger::unshelve(Worker& worker) { roomy_.erase(room_of(worker)); }

}  // namespace tessera
