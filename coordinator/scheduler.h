// SPDX-License-Identifier: Apache-2.0
// Decides who does what. No sockets, threads, clocks or pixels: news and time come in, decisions go out.
//
// A worker holds a lease on each task it was given. Any word from it renews all its leases; silence ends
// them, slowness does not. A task is accepted once, with the first result that comes, whoever sends it; every
// other copy is revoked. Messages may be lost, late, doubled or out of order: what a worker says it holds is
// compared with what it was given, and the difference is made good (see docs/PROTOCOL.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coordinator/ledger.h"
#include "coordinator/roster.h"
#include "coordinator/scheduling.h"
#include "core/instant.h"

namespace tessera {

class Scheduler {
 public:
  explicit Scheduler(const SchedulerOptions& options)
      : options_(options), roster_(options), ledger_(options, roster_) {}

  // `now` never goes back. Amortised O(log n) for n tasks and workers, plus the length of the event.
  std::vector<Command> handle(const Event& event, Instant now);
  // When TimePassed is due.
  std::optional<Instant> next_deadline() const;

  SchedulerCounts counts() const;
  // Of all that are there, by id.
  std::vector<WorkerFigures> workers() const;

 private:
  using DeviceClass = book::DeviceClass;
  using Job = book::Job;
  using Name = book::Name;
  using Task = book::Task;
  using Worker = book::Worker;
  enum class Served : std::uint8_t { yes, not_now, nothing };
  struct Turn {  // the next worker of a class to be asked, while tasks are given out
    DeviceClass* kind;
    book::Room next;
  };

  void on(const Joined&);
  void on(const Heard&);
  void on(const Done&);
  void on(const Failed&);
  void on(const Left&);
  void on(const Submitted&);
  void on(const Reranked&);
  void on(const PausedJob&);
  void on(const ResumedJob&);
  void on(const WithdrawnTasks&);
  void on(const WithdrawnJob&);
  void on(const Released&);
  void on(const TimePassed&);

  Worker* listen(const WorkerId&);
  void compare(Worker&, const std::vector<Held>&);
  void reported(Worker&, const Held&);
  bool may_answer(const Task&, const WorkerId&, const Worker*) const;
  void learn(Worker&, const Task&, double seconds);
  void strike(Task&, Worker&, const std::string& reason, std::uint64_t incident);
  bool poisonous(const Task&) const;
  bool hopeless(const Task&) const;
  bool try_another_class(Task&);
  void convict(const std::vector<book::Failure>&, const Name* but);
  void set_aside(Name&);
  void release(Task&, Worker&);
  void release_all(Worker&, bool dead);
  void dismiss(Worker&);
  void forget(Worker&);
  void gave_up_class(DeviceClass&);
  void revoke(Task&, Worker&);
  void revoke_all(Task&);
  void give_up(Task&, const std::string& reason, bool bad_input);
  void erase(Task&);

  void dispatch();
  Served serve(Worker&);
  Task* take_over_for(const Worker&);
  bool others_might_find(const Worker&) const;
  bool may_have(const Worker&, const Task&) const;
  Task* queued_elsewhere(const Worker&);
  Task* double_for(const Worker&);
  void take_over(Task&);
  void entrust(Task&, Worker&, Attempt);

  friend class Audit;  // of tests, which look into the books

  SchedulerOptions options_;
  Roster roster_;
  Ledger ledger_;
  Instant now_{};
  std::uint64_t incidents_ = 0;
  SchedulerCounts counts_;
  std::vector<Turn> turns_;
  std::vector<Command> out_;
};

}  // namespace tessera
