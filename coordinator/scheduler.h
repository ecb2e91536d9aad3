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
#include <variant>
#include <vector>

#include "coordinator/ledger.h"
#include "core/instant.h"
#include "core/task.h"
#include "proto/message.h"

namespace tessera {

struct SchedulerOptions {
  Millis silence{10'000};  // a worker that says nothing for so long is given up
  Millis grace{3'000};     // a task that its worker has not reported for so long was lost on the way
  int max_attempts = 3;    // failures, and deaths of workers that were at it, before a task is given up
  int ahead = 1;           // tasks per slot that a worker holds beyond those at work, so that it never waits
  bool endgame = true;     // a slot with nothing else to do works on a second copy of somebody's task
};

// News. Anything a worker says is one of these, so that every word of it renews its leases.
struct Joined {
  WorkerId worker;
  int slots = 1;
};
struct Heard {
  WorkerId worker;
  std::optional<std::vector<Held>> held = {};  // of a heartbeat: all that it has in hand
};
struct Done {
  WorkerId worker;
  TaskId task = 0;
  Attempt attempt = 0;
};
struct Failed {
  WorkerId worker;
  TaskId task = 0;
  Attempt attempt = 0;
  std::string reason;
  bool bad_input = false;  // a retry is useless
};
struct Left {
  WorkerId worker;
};
struct Wish {
  TaskId task = 0;
  JobId job = 0;
};
struct Submitted {
  std::vector<Wish> tasks;  // in the order in which they are wanted, after all of their rank that came before
  std::uint32_t rank = 0;   // below 2^24; the lower, the sooner
};
struct WithdrawnTasks {
  std::vector<TaskId> tasks;
};
struct WithdrawnJob {
  JobId job = 0;
};
// Only this ends leases. To be sent when no mail waits to be read: what a worker said, but nobody has read
// yet, is no silence.
struct TimePassed {};
using Event =
    std::variant<Joined, Heard, Done, Failed, Left, Submitted, WithdrawnTasks, WithdrawnJob, TimePassed>;

// Decisions.
struct AssignTask {
  WorkerId worker;
  TaskId task = 0;
  Attempt attempt = 0;
  bool operator==(const AssignTask&) const = default;
};
struct RevokeTask {
  WorkerId worker;
  TaskId task = 0;
  Attempt attempt = 0;
  bool operator==(const RevokeTask&) const = default;
};
struct Accept {  // the result that has just come is the task's result; once a task
  TaskId task = 0;
  bool operator==(const Accept&) const = default;
};
struct GiveUp {
  TaskId task = 0;
  std::string reason;
  bool bad_input = false;
  bool operator==(const GiveUp&) const = default;
};
struct Forget {  // the worker fell silent
  WorkerId worker;
  bool operator==(const Forget&) const = default;
};
struct AskHello {  // a stranger spoke
  WorkerId worker;
  bool operator==(const AskHello&) const = default;
};
using Command = std::variant<AssignTask, RevokeTask, Accept, GiveUp, Forget, AskHello>;

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
