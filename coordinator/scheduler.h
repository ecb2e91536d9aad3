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
#include "coordinator/scheduling.h"
#include "core/instant.h"

namespace tessera {

struct SchedulerOptions {
  Millis silence{10'000};  // a worker that says nothing for so long is given up
  Millis grace{3'000};     // a task that its worker has not reported for so long was lost on the way
  int max_attempts = 3;    // failures, and deaths of workers that were at it, before a task is given up
  int ahead = 1;           // tasks per slot that a worker holds beyond those at work, so that it never waits
  bool endgame = true;     // a slot with nothing else to do works on a second copy of somebody's task
};

class Scheduler {
 public:
  explicit Scheduler(const SchedulerOptions& options) : options_(options), ledger_(options.ahead) {}

  // `now` never goes back. Amortised O(log n) for n tasks and workers, plus the length of the event.
  std::vector<Command> handle(const Event& event, Instant now);
  // When TimePassed is due.
  std::optional<Instant> next_deadline() const;

 private:
  using Worker = Ledger::Worker;
  using Task = Ledger::Task;

  void on(const Joined&);
  void on(const Heard&);
  void on(const Done&);
  void on(const Failed&);
  void on(const Left&);
  void on(const Submitted&);
  // Not yet: tasks go by their ranks alone.
  void on(const Reranked&) {}
  void on(const PausedJob&) {}
  void on(const ResumedJob&) {}
  void on(const Released&) {}
  void on(const WithdrawnTasks&);
  void on(const WithdrawnJob&);
  void on(const TimePassed&);

  Worker* listen(const WorkerId&);
  void compare(Worker&, const std::vector<Held>&);
  void reported(Worker&, const Held&);
  void strike(Task&, const WorkerId&, const std::string& reason);
  void release(Task&, Worker&);
  void release_all(Worker&, bool dead);
  void revoke_all(Task&);
  void give_up(Task&, const std::string& reason, bool bad_input);

  void dispatch();
  bool nothing_to_give(const Worker& next) const;
  bool may_try(const Task&, const Worker&);
  Task* next_for(const Worker&);
  Task* double_for(const Worker&);

  SchedulerOptions options_;
  Ledger ledger_;
  Instant now_{};
  std::vector<Command> out_;
};

}  // namespace tessera
