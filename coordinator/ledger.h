// SPDX-License-Identifier: Apache-2.0
// Who holds a copy of which task, and what waits: the book-keeping under the Scheduler, which decides. Every
// operation costs O(log n) at most.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/instant.h"
#include "core/task.h"
#include "proto/message.h"

namespace tessera {

class Ledger {
 public:
  struct Worker;
  struct Task;

  // One worker's hold on a task.
  struct Lease {
    Worker* worker = nullptr;
    Attempt attempt = 0;
    Instant since{};          // it began, as far as is known here
    Instant seen{};           // the worker was given it, or said that it holds it
    std::uint64_t order = 0;  // over all leases of the ledger
    bool running = false;     // workers take up tasks in order: the first `slots` of its leases are at work
  };

  struct Task {
    TaskId id = 0;
    JobId job = 0;
    std::uint64_t wish = 0;     // the lower, the sooner
    int strikes = 0;            // attempts that failed or died with their worker
    Attempt attempts = 0;       // so far
    std::vector<Lease> leases;  // at most two
    std::vector<WorkerId> failed_on;
    std::string reason;  // of the last strike
    bool waiting = false;
    bool lent_to(const Worker& w) const;
  };

  using WaitingTasks = std::map<std::uint64_t, Task*>;                   // by wish
  using LoneTasks = std::map<std::pair<Instant, std::uint64_t>, Task*>;  // by (since, order)

  // How full, how many, who was first: lower comes first.
  using Room = std::tuple<int, int, std::uint64_t>;

  struct Worker {
    WorkerId id;
    int slots = 1;
    std::uint64_t number = 0;  // in order of joining
    Instant last_word{};
    bool gone = false;  // said goodbye: kept a while, so that a late message does not bring it back
    WaitingTasks running, queued;  // by order of lease
    std::list<Worker*>::iterator by_word;
    int held() const { return static_cast<int>(running.size() + queued.size()); }
    bool idle() const { return held() < slots; }
  };

  // `ahead`: tasks per slot that a worker may hold beyond those at work.
  explicit Ledger(int ahead) : ahead_(ahead) {}
  Ledger(const Ledger&) = delete;
  Ledger& operator=(const Ledger&) = delete;

  Worker* worker(const WorkerId&);
  Task* task(TaskId);

  // Workers.
  Worker& join(const WorkerId&, int slots, Instant now);  // a new one, or new slots for a known one
  void hear(Worker&, Instant now);
  void retire(Worker&);  // gone: takes no more. Precondition: holds nothing
  void forget(Worker&);  // Precondition: holds nothing
  Worker* quietest() const { return by_word_.empty() ? nullptr : by_word_.front(); }
  std::size_t present() const { return workers_.size() - retired_; }
  const std::map<Room, Worker*>& roomy() const { return roomy_; }  // may take a task; idle ones first

  // Tasks.
  // Waiting, behind all of its rank and before those of higher ones. Precondition: not known.
  Task& add(TaskId, JobId, std::uint32_t rank);
  void erase(Task&);  // Precondition: nobody holds it
  void wait(Task&);   // back among those that wait
  const WaitingTasks& fresh() const { return fresh_; }
  const WaitingTasks& retried() const { return retried_; }       // those that failed on some worker
  const LoneTasks& lone_queued() const { return lone_queued_; }  // exactly one lease, not at work yet
  const LoneTasks& lone_running() const { return lone_running_; }
  std::vector<TaskId> tasks_of(JobId) const;  // ascending

  // Leases. The task leaves those that wait.
  void lend(Task&, Worker&, Attempt, Instant now);
  void take_back(Task&, Worker&, Instant now);  // Precondition: task.lent_to(worker)

 private:
  void list_lone(Task&);
  void unlist_lone(Task&);
  void shelve(Worker&);
  void unshelve(Worker&);
  void promote(Worker&, Instant now);
  void unwait(Task&);

  int ahead_;
  std::uint64_t wishes_ = 0, orders_ = 0, joins_ = 0;
  std::size_t retired_ = 0;
  std::unordered_map<TaskId, Task> tasks_;
  std::unordered_map<JobId, std::unordered_set<TaskId>> jobs_;
  std::unordered_map<WorkerId, Worker> workers_;
  std::list<Worker*> by_word_;  // the quietest first
  std::map<Room, Worker*> roomy_;
  WaitingTasks fresh_, retried_;
  LoneTasks lone_queued_, lone_running_;
};

}  // namespace tessera
