// SPDX-License-Identifier: Apache-2.0
#include "coordinator/ledger.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <utility>

namespace tessera {
namespace {

// A worker's queue is no longer, however short its tasks; agents refuse more than four times as many.
constexpr int kMostAhead = 1024;
constexpr double kUnknown = 1e6;  // seconds: whoever has a queue and no known speed is relieved first

book::Room room_of(const book::Worker& w) { return {w.held() / w.slots, w.held(), w.number}; }

book::Burden burden_of(const book::Worker& w) {
  return {-seconds_in_hand(w).value_or(kUnknown * w.held() / w.slots), w.number};
}

// The worker's place in a list is now under this key.
template <class Key>
void move(std::map<Key, book::Worker*>& list, std::optional<Key>& old, const std::optional<Key>& now,
          book::Worker& worker) {
  if (old == now) return;
  if (old && now) {
    auto node = list.extract(*old);
    node.key() = *now;
    list.insert(std::move(node));
  } else if (old) {
    list.erase(*old);
  } else {
    list.emplace(*now, &worker);
  }
  old = now;
}

}  // namespace

std::optional<double> seconds_in_hand(const book::Worker& w) {
  double seconds = 0;
  for (const int kind : {0, 1}) {
    if (w.held_cost[kind] > 0 && w.rate[kind] == 0) return std::nullopt;
    seconds += w.held_cost[kind] * w.rate[kind];
  }
  return seconds / w.slots;
}

// --- Jobs. ---

Ledger::Job& Ledger::job(JobId id) {
  Job& job = jobs_[id];
  job.id = id;
  return job;
}

Ledger::Job* Ledger::find_job(JobId id) {
  const auto it = jobs_.find(id);
  return it == jobs_.end() ? nullptr : &it->second;
}

void Ledger::rerank(Job& job, const Standing& standing) {
  if (job.standing == standing) return;
  waiting_.unlist(job);
  job.standing = standing;
  waiting_.list(job);
}

void Ledger::pause(Job& job, bool paused) {
  waiting_.unlist(job);
  job.paused = paused;
  waiting_.list(job);
}

void Ledger::choose_class(Job& job, DeviceClass* kind) {
  waiting_.unlist(job);
  DeviceClass* old = std::exchange(job.filter_class, kind);
  if (kind) {
    ++kind->users;
    kind->jobs.emplace(job.id, &job);
    job.last_class = kind->name;
  }
  waiting_.list(job);
  if (!old) return;
  old->jobs.erase(job.id);
  roster_.drop_class(*old);
}

void Ledger::erase(Job& job) {
  assert(job.tasks.empty());
  if (job.filter_class) choose_class(job, nullptr);
  jobs_.erase(JobId(job.id));
}

void Ledger::forget_if_idle(Job& job) {
  if (job.tasks.empty() && !job.paused && !job.last_class) jobs_.erase(JobId(job.id));
}

// --- Tasks. ---

Ledger::Task* Ledger::task(TaskId id) {
  const auto it = tasks_.find(id);
  return it == tasks_.end() ? nullptr : it->second;
}

Ledger::Task& Ledger::add(const Wish& wish, Job& job) {
  assert(wish.cost > 0);
  Task& task = job.tasks.emplace_back();
  task.self = std::prev(job.tasks.end());
  [[maybe_unused]] const bool fresh = tasks_.emplace(wish.task, &task).second;
  assert(fresh);
  task.id = wish.task;
  task.job = &job;
  task.order = submitted_++;
  task.cost = wish.cost;
  task.bytes = wish.bytes;
  task.filter = wish.filter;
  if (!wish.scene.empty()) task.scene = std::hash<std::string>{}(wish.scene) | 1;
  task.avoid = wish.avoid;
  if (!wish.device_class.empty()) task.only = &roster_.use_class(wish.device_class);
  waiting_.add(task);
  return task;
}

void Ledger::erase(Task& task) {
  assert(task.leases.empty());
  if (task.line) waiting_.remove(task);
  DeviceClass* only = task.only;
  tasks_.erase(task.id);
  task.job->tasks.erase(task.self);
  if (only) roster_.drop_class(*only);
}

void Ledger::wait(Task& task) {
  assert(task.leases.empty());
  waiting_.add(task);
}

// --- Leases. ---

void Ledger::lend(Task& task, Worker& worker, Attempt attempt, Instant now) {
  assert(!task.leases.full() && !task.leases.of(worker) && worker.able());
  if (task.line) waiting_.give(task);
  unlist_lone(task);
  if (task.leases.empty()) ++running_;
  task.attempts = std::max(task.attempts, attempt);
  const book::Lease& lease = task.leases.add({&worker, attempt, now, now, now, orders_++});
  worker.queued.emplace_hint(worker.queued.end(), lease.order, &task);
  worker.queued_bytes += task.bytes;
  worker.held_cost[task.filter] += task.cost;
  list_lone(task);
  settle(worker, now);
}

void Ledger::take_back(Task& task, Worker& worker, Instant now) {
  book::Lease* lease = task.leases.of(worker);
  assert(lease);
  unlist_lone(task);
  if (lease->running) {
    worker.running.erase(lease->order);
  } else {
    worker.queued.erase(lease->order);
    worker.queued_bytes -= task.bytes;
  }
  worker.held_cost[task.filter] = worker.held() == 0 ? 0 : worker.held_cost[task.filter] - task.cost;
  task.leases.remove(lease);
  if (task.leases.empty()) --running_;
  list_lone(task);
  settle(worker, now);
}

// What a free slot takes up next.
void Ledger::promote(Worker& worker, Instant now) {
  while (static_cast<int>(worker.running.size()) < worker.slots && !worker.queued.empty()) {
    auto node = worker.queued.extract(worker.queued.begin());
    Task& task = *node.mapped();
    unlist_lone(task);
    book::Lease* lease = task.leases.of(worker);
    lease->running = true;
    lease->since = now;
    worker.queued_bytes -= task.bytes;
    worker.running.insert(std::move(node));
    list_lone(task);
  }
}

// Not one that had chances enough: with ever new copies it would never be given up, or go to another class.
void Ledger::list_lone(Task& task) {
  if (task.leases.size() != 1 || task.strikes >= options_.max_attempts) return;
  const book::Lease& lease = *task.leases.begin();
  DeviceClass* kind = class_for(task);
  const bool last_chance =
      kind && task.strikes >= book::kClassAttempts && !roster_.anybody_else(terms_of(task));
  if (!lease.running || last_chance) return;
  task.lone = kind ? &kind->lone : &lone_;
  task.lone->emplace(std::pair{lease.since, lease.order}, &task);
}

void Ledger::unlist_lone(Task& task) {
  if (!task.lone) return;
  const book::Lease& lease = *task.leases.begin();
  task.lone->erase({lease.since, lease.order});
  task.lone = nullptr;
}

// --- Workers. ---

void Ledger::settle(Worker& worker, Instant now) {
  promote(worker, now);
  shelve(worker);
}

void Ledger::shut(Worker& worker) {
  move(worker.device_class->roomy, worker.room, {}, worker);
  move(burdened_, worker.burden, {}, worker);
}

void Ledger::shelve(Worker& worker) {
  if (!worker.able()) return shut(worker);
  move(worker.device_class->roomy, worker.room,
       has_room(worker) ? std::optional(room_of(worker)) : std::nullopt, worker);
  move(burdened_, worker.burden, worker.queued.empty() ? std::nullopt : std::optional(burden_of(worker)),
       worker);
}

bool Ledger::has_room(const Worker& worker) const {
  if (worker.held() < std::int64_t(worker.slots) * (1 + options_.ahead)) return true;
  if (worker.held() >= worker.slots + kMostAhead) return false;
  const std::optional<double> seconds = seconds_in_hand(worker);
  return seconds && *seconds < options_.lease_seconds;
}

bool Ledger::fits(const Task& task, const Worker& worker) const {
  return worker.idle() || task.bytes == 0 || worker.queued_bytes + task.bytes <= options_.bytes_ahead;
}

}  // namespace tessera
