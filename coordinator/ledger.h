// SPDX-License-Identifier: Apache-2.0
// Tasks, jobs, and who holds a copy of which task: the book-keeping under the Scheduler, which decides. Every
// operation costs O(log n) at most, but for those on jobs.
#pragma once

#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "coordinator/records.h"
#include "coordinator/waiting.h"

namespace tessera {

class Ledger {
 public:
  using DeviceClass = book::DeviceClass;
  using Job = book::Job;
  using Task = book::Task;
  using Worker = book::Worker;

  Ledger(const SchedulerOptions& options, Roster& roster)
      : options_(options), roster_(roster), waiting_(roster, options.affinity_slack) {}
  Ledger(const Ledger&) = delete;
  Ledger& operator=(const Ledger&) = delete;

  // Jobs: remembered while they have tasks, are paused or have a class; until erase() at the latest.
  Job& job(JobId);  // a new one, if it is not known
  Job* find_job(JobId);
  void rerank(Job&, const Standing&);
  void pause(Job&, bool paused);
  void choose_class(Job&, DeviceClass*);  // none: whoever gets the next filter task chooses
  void erase(Job&);                       // Precondition: it has no tasks
  void forget_if_idle(Job&);

  // Tasks.
  Task* task(TaskId);
  Task& add(const Wish&, Job&);  // waits, behind all of its rank. Precondition: not known
  void erase(Task&);             // Precondition: nobody holds it
  void wait(Task&);              // back among those that wait
  Waiting& waiting() { return waiting_; }
  const Waiting& waiting() const { return waiting_; }
  std::size_t tasks() const { return tasks_.size(); }
  std::size_t running() const { return running_; }

  // Leases. The task leaves those that wait.
  void lend(Task&, Worker&, Attempt, Instant now);
  void take_back(Task&, Worker&, Instant now);  // Precondition: the worker has it

  // Workers.
  void settle(Worker&, Instant now);  // slots, rate or whether it is able have changed
  void shut(Worker&);                 // it is given nothing more, and nothing is taken from its queue
  bool fits(const Task&, const Worker&) const;  // in what may travel ahead to it
  // By how long they have to do: those with a queue.
  const std::map<book::Burden, Worker*>& burdened() const { return burdened_; }
  const book::LoneTasks& lone() const { return lone_; }  // that any class may do

 private:
  void list_lone(Task&);
  void unlist_lone(Task&);
  void promote(Worker&, Instant now);
  void shelve(Worker&);
  bool has_room(const Worker&) const;

  friend class Audit;

  SchedulerOptions options_;
  Roster& roster_;
  Waiting waiting_;
  std::uint64_t submitted_ = 0, orders_ = 0;
  std::size_t running_ = 0;
  std::unordered_map<TaskId, Task*> tasks_;
  std::unordered_map<JobId, Job> jobs_;
  std::map<book::Burden, Worker*> burdened_;
  book::LoneTasks lone_;
};

// Expected seconds until a worker is through with what it has; none: its speed is not known.
std::optional<double> seconds_in_hand(const book::Worker&);

}  // namespace tessera
