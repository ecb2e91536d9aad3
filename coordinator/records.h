// SPDX-License-Identifier: Apache-2.0
// What the scheduler knows of each task, job and worker. Plain data: the Roster keeps workers, the Ledger
// tasks and leases, Waiting what waits, each in its own order; pointers hold as long as what they point to is
// known there.
#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "coordinator/scheduling.h"

namespace tessera::book {

struct Job;
struct Lane;
struct Line;
struct Task;
struct Worker;

// How full, how many, who was first: the lower, the sooner it is given a task.
using Room = std::tuple<int, int, std::uint64_t>;
// Seconds until it is through with what it has, negated; who was first: the lower, the sooner it is relieved.
using Burden = std::pair<double, std::uint64_t>;

// Tasks at work in one copy, the longest first: by (since, order) of the lease.
using LoneTasks = std::map<std::pair<Instant, std::uint64_t>, Task*>;

// Whom failures are counted by: workers under one name, one after the other or at the same time.
struct Name {
  std::string name;
  std::vector<Worker*> workers;  // that are there
  std::string set_aside;         // why; empty: it is not
  bool tried = false;            // it has done something right
  int row = 0;                   // failures since it did something right, whoever is to blame
  std::uint64_t last_incident = 0;
  Instant last_failed{};
  bool steady = false;             // what it did last, it did right,
  Instant last_success{};          // then
  std::set<std::uint64_t> proven;  // those that were its own: others did what it could not
  std::string last_failure;
  std::list<Name*>::iterator place;  // among the steady ones, or those that are away
  bool away = false;
  bool able() const { return set_aside.empty() && !workers.empty(); }
};

// The unit within which bits are promised equal.
struct DeviceClass {
  std::string name;
  std::map<const Name*, int> able;  // how many workers of each name may be given tasks
  int users = 0;                    // workers, jobs and tasks that speak of it
  std::map<JobId, Job*> jobs;       // whose filter tasks are its own
  std::map<Room, Worker*> roomy;    // workers that may be given a task; those with an idle slot first
  LoneTasks lone;                   // that only this class may do
};

struct Worker {
  WorkerId id;
  Name* name = nullptr;
  DeviceClass* device_class = nullptr;
  int slots = 1;
  std::uint64_t number = 0;  // in order of joining, from 1
  Instant last_word{};       // or when it was prompted
  bool prompted = false;     // given something to do since its last word, when it had nothing
  bool at_work = false;      // as far as its silence goes
  bool gone = false;         // said goodbye: kept a while, so that a late message does not bring it back
  std::map<std::uint64_t, Task*> running, queued;  // by order of lease
  std::array<double, 2> held_cost{};               // of render and of filter tasks in hand
  std::array<double, 2> rate{};                    // seconds per cost of each, smoothed; 0: not known
  double pace = 0;                                 // seconds per task, smoothed
  std::uint64_t queued_bytes = 0;
  std::array<std::uint64_t, 2> scenes{};  // of its last tasks; 0: none
  std::uint64_t done = 0, failed = 0;
  std::optional<Room> room;      // its key among the roomy ones, if it is one
  std::optional<Burden> burden;  // and among those with a queue
  std::list<Worker*>::iterator by_word;

  int held() const { return static_cast<int>(running.size() + queued.size()); }
  bool idle() const { return held() < slots; }
  bool able() const { return !gone && name->set_aside.empty(); }
};

// One worker's hold on a task.
struct Lease {
  Worker* worker = nullptr;
  Attempt attempt = 0;
  Instant given{};
  Instant since{};          // it began, as far as is known here
  Instant seen{};           // the worker was given it, or said that it holds it
  std::uint64_t order = 0;  // over all leases of the ledger
  bool running = false;     // workers take up tasks in order: the first `slots` of its leases are at work
};

// Never more than two copies of a task are out.
class Leases {
 public:
  Lease* begin() { return all_.data(); }
  Lease* end() { return all_.data() + count_; }
  const Lease* begin() const { return all_.data(); }
  const Lease* end() const { return all_.data() + count_; }
  int size() const { return count_; }
  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == static_cast<int>(all_.size()); }
  Lease& add(const Lease& lease) { return all_[count_++] = lease; }  // Precondition: !full()
  void remove(Lease* lease) { *lease = all_[--count_]; }
  Lease* of(const Worker& worker) {  // null: it has none
    for (Lease& lease : *this)
      if (lease.worker == &worker) return &lease;
    return nullptr;
  }

 private:
  std::array<Lease, 2> all_{};
  int count_ = 0;
};

// Who may do a task. Those on whom it failed may once it has failed on everybody else.
struct Terms {
  DeviceClass* device_class = nullptr;  // none: all of them
  std::string avoid;                    // id or name of a worker
  std::vector<std::string> failed_on;   // names, ascending
  auto operator<=>(const Terms&) const = default;
  bool plain() const { return avoid.empty() && failed_on.empty(); }
};

struct Failure {
  std::string name;
  std::uint64_t incident = 0;  // that which ends several tasks at a time is one
};

struct Task {
  TaskId id = 0;
  Job* job = nullptr;
  std::uint64_t order = 0;  // of submission
  double cost = 1;
  std::uint64_t scene = 0, bytes = 0;  // scene: a hash of its hash; 0: none
  bool filter = false;
  bool witnessed = false;  // it failed on a worker that can do others, or ended one
  int strikes = 0;         // attempts that failed or died with their worker
  Attempt attempts = 0;    // so far
  Leases leases;
  Line* line = nullptr;          // it waits there
  LoneTasks* lone = nullptr;     // it is listed there
  std::uint64_t moved_from = 0;  // the worker whose queue it was taken out of
  Attempt moved_attempt = 0;     // which it had there
  DeviceClass* only = nullptr;   // none: any may do it
  std::string avoid;
  std::vector<Failure> failures;  // one for each name, by name
  std::string reason;             // of the last strike
  std::list<Task>::iterator self;
};

// Waiting tasks of one job that the same workers may do.
struct Line {
  Job* job = nullptr;
  bool filter = false;
  Terms terms;                           // but for the class of the job's filter tasks
  std::map<std::uint64_t, Task*> tasks;  // by order
  Lane* lane = nullptr;                  // where it stands; none: its job is paused, or nothing waits
  std::uint64_t head = 0;                // order of its first task, under which it is listed
};

struct Job {
  JobId id = 0;
  Standing standing;
  bool paused = false;
  DeviceClass* filter_class = nullptr;    // that does its filter tasks; none: the first one that gets one
  std::optional<std::string> last_class;  // the one before, or this one; none: no class was chosen yet
  std::set<std::string> spoiled;          // classes all of whose workers failed at one of its filter tasks
  std::list<Task> tasks;
  std::map<std::pair<bool, Terms>, Line> lines;
};

// The class that alone may do it, as it stands.
inline DeviceClass* class_for(const Task& task) {
  if (task.only) return task.only;
  return task.filter ? task.job->filter_class : nullptr;
}

// Strikes after which a filter task that failed on everybody of its class goes to another one.
inline constexpr int kClassAttempts = 3;

// Who may do it, as it stands.
inline Terms terms_of(const Task& task) {
  Terms terms{class_for(task), task.avoid, {}};
  for (const Failure& f : task.failures) terms.failed_on.push_back(f.name);
  return terms;
}

}  // namespace tessera::book
