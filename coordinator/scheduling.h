// SPDX-License-Identifier: Apache-2.0
// What the scheduler is told and what it decides, as values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/instant.h"
#include "core/task.h"
#include "proto/message.h"

namespace tessera {

struct SchedulerOptions {
  Millis silence{10'000};  // a worker at work that says nothing for so long is given up,
  int idle_patience = 3;   // one with nothing in hand after so many times as long
  Millis grace{3'000};     // a task that its worker has not reported for so long was lost on the way
  // Workers on which a task fails, or that die at it, before it is given up; attempts, if there are not so
  // many workers.
  int max_attempts = 3;
  int ahead = 1;               // tasks per slot that a worker holds beyond those at work, at least,
  double lease_seconds = 1.0;  // and as many as last so long, if that is known
  std::uint64_t bytes_ahead = std::uint64_t{64} << 20;  // that travelled with tasks not at work yet, at most
  bool endgame = true;  // a slot with nothing else to do takes over, or works on a second copy of, a task
  // A worker may be given a task of a scene that it has loaded, though its flow has had so much more than
  // that whose turn it is. In units of cost.
  double affinity_slack = 1 << 22;
  int set_aside_after = 5;  // failures in a row at what others can do; 0: never
};

// --- News. Anything a worker says is one of these, so that every word of it renews its leases. ---

struct Joined {
  WorkerId worker;
  int slots = 1;
  std::string device_class = {};
  // Failures are counted by it, so that a worker that starts again under another id does not begin anew;
  // empty: its id.
  std::string name = {};
};
struct Heard {
  WorkerId worker;
  std::optional<std::vector<Held>> held = {};  // of a heartbeat: all that it has in hand
};
struct Done {
  WorkerId worker;
  TaskId task = 0;
  Attempt attempt = 0;
  double seconds = 0;  // of work, as the worker says; 0: not known
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

// Where the tasks of a job stand in line.
struct Standing {
  std::uint64_t rank = 0;  // within the flow; the lower, the sooner, then by order of submission
  int band = 0;            // the higher, the sooner, always
  std::string flow = {};   // within a band, flows (owners) get equal shares by cost
  bool operator==(const Standing&) const = default;
};
struct Wish {
  TaskId task = 0;
  JobId job = 0;
  double cost = 1;                // pixel samples, or what takes about as long; above 0
  bool filter = false;            // all such tasks of a job are done by workers of one device class
  std::string scene = {};         // hash of what a worker must have loaded for it; empty: nothing
  std::uint64_t bytes = 0;        // that travel with it
  WorkerId avoid = {};            // id or name of a worker that must not do it; empty: none
  std::string device_class = {};  // only workers of it may; empty: any
};
// A job is remembered until it is withdrawn.
struct Submitted {
  std::vector<Wish> tasks;  // in the order in which they are wanted, after all that were submitted before
  Standing standing = {};   // of their jobs, from now on
};
struct Reranked {
  JobId job = 0;
  Standing standing = {};
};
struct PausedJob {  // its waiting tasks, and those to come, are put aside; those given out go on
  JobId job = 0;
};
struct ResumedJob {
  JobId job = 0;
};
struct WithdrawnTasks {
  std::vector<TaskId> tasks;
};
struct WithdrawnJob {
  JobId job = 0;
};
struct Released {      // one that was set aside gets another chance
  std::string worker;  // id or name
};
// Only this ends leases. To be sent when no mail waits to be read: what a worker said, but nobody has read
// yet, is no silence.
struct TimePassed {};
using Event = std::variant<Joined, Heard, Done, Failed, Left, Submitted, Reranked, PausedJob, ResumedJob,
                           WithdrawnTasks, WithdrawnJob, Released, TimePassed>;

// --- Decisions. ---

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
struct ClassChanged {  // filter tasks of the job are done by another device class from now on
  JobId job = 0;
  std::string from, to;  // from: empty, if they are the first
  bool operator==(const ClassChanged&) const = default;
};
struct SetAside {  // it gets no more tasks until it is Released, nor does another worker of its name
  WorkerId worker;
  std::string name, reason;
  bool operator==(const SetAside&) const = default;
};
using Command =
    std::variant<AssignTask, RevokeTask, Accept, GiveUp, Forget, AskHello, ClassChanged, SetAside>;

// --- Figures. ---

// Since the scheduler began; the second half: now.
struct SchedulerCounts {
  std::uint64_t assigned = 0, accepted = 0, revoked = 0, retried = 0, given_up = 0;
  std::uint64_t moved = 0;    // from a queue to an idle slot
  std::uint64_t doubled = 0;  // second copies given out
  std::uint64_t dropped = 0;  // results of tasks that were done already, or are not wanted
  std::size_t workers = 0, set_aside = 0;
  std::size_t waiting = 0, running = 0;  // tasks; running: some worker has it
  bool operator==(const SchedulerCounts&) const = default;
};
struct WorkerFigures {
  WorkerId worker;
  std::string name, device_class;
  int slots = 0, held = 0;
  std::uint64_t done = 0, failed = 0;
  double tasks_per_second = 0;  // of late; 0: not known
  std::string set_aside;        // why; empty: it works
};

}  // namespace tessera
