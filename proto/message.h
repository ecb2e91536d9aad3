// SPDX-License-Identifier: Apache-2.0
// What coordinator and workers say to each other, as values. On the wire: one protobuf part (tessera.proto)
// and, behind it, pixel payloads as parts of their own. See docs/PROTOCOL.md.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/instant.h"
#include "core/job.h"
#include "core/task.h"
#include "proto/questions.h"

namespace tessera {

using WorkerId = std::string;  // chosen by the worker, new each time it starts; 1..64 printable characters
using Attempt = std::uint32_t;

inline constexpr int kProtocolVersion = 6;

// Worker to coordinator.
struct Hello {
  int protocol = kProtocolVersion;
  std::string version;       // of tessera
  std::string device_class;  // unit within which bits are promised equal
  int slots = 1;             // tasks it works on at a time
  std::string name;          // for people: its machine, or what it was told to call itself
};
// One copy of a task that a worker has in hand, whether it is at it or keeps it for later.
struct Held {
  TaskId task = 0;
  Attempt attempt = 0;
  bool operator==(const Held&) const = default;
};
// Sent at the agreed interval, whatever else is said: it is how lost Assign, Revoke and Done are noticed.
struct Heartbeat {
  std::vector<Held> held;
};
struct NeedJob {  // a task of a job came whose offer did not, or is forgotten: answered by JobOffer or
                  // JobOver
  JobId id = 0;
};
struct RenderDone {
  TaskId task = 0;
  Attempt attempt = 0;
  Block block;                // sums travel as a part of their own
  double seconds = 0;         // of work
  std::uint64_t dropped = 0;  // samples that were NaN or infinite
};
struct FilterDone {
  TaskId task = 0;
  Attempt attempt = 0;
  Filtered filtered;  // a part of its own
  double seconds = 0;
};
struct TaskFailed {
  TaskId task = 0;
  Attempt attempt = 0;
  std::string reason;
  bool bad_input = false;  // a retry is useless: the scene or the job itself is wrong
};
struct Goodbye {};  // takes no more tasks; leases go back

// Coordinator to worker.
struct Welcome {
  int protocol = kProtocolVersion;
  Millis heartbeat{1000};       // say something at least this often
  Millis idle_heartbeat{1000};  // the same while nothing is in hand; at least `heartbeat`
};
struct Refused {  // the worker must not come back as it is
  std::string reason;
};
struct JobOffer {  // answers NeedJob; may be sent ahead of a job's first task
  JobId id = 0;
  Job job;
};
struct Assign {
  Task task;
  Attempt attempt = 0;
  FilterInput input;  // a part of its own
};
struct Revoke {  // stop, if still at it; no answer is wanted
  TaskId task = 0;
  Attempt attempt = 0;
};
struct JobOver {  // forget it; its scene may stay cached
  JobId id = 0;
};
struct Unknown {};  // I do not know you (any more): say Hello again

using Message = std::variant<Hello, Heartbeat, RenderDone, FilterDone, TaskFailed, Goodbye, Welcome, Refused,
                             JobOffer, Assign, Revoke, JobOver, Unknown, NeedJob, Ask, Answer>;

}  // namespace tessera
