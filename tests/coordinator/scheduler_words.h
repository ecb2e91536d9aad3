// SPDX-License-Identifier: Apache-2.0
// Short words for talking to a Scheduler in tests.
#pragma once

#include <gmock/gmock.h>

#include <vector>

#include "coordinator/scheduler.h"

namespace tessera {

inline Instant at(double s) { return Instant(std::chrono::microseconds(static_cast<std::int64_t>(s * 1e6))); }

inline Submitted wishes(TaskId first, TaskId last, JobId job = 1) {
  Submitted event;
  for (TaskId id = first; id < last; ++id) event.tasks.push_back({id, job});
  return event;
}

// Commands that are Kind, in order.
template <class Kind>
std::vector<Kind> only(const std::vector<Command>& commands) {
  std::vector<Kind> found;
  for (const Command& c : commands)
    if (const auto* kind = std::get_if<Kind>(&c)) found.push_back(*kind);
  return found;
}

inline const SchedulerOptions kPlain{
    .silence = Millis{10'000}, .grace = Millis{3'000}, .max_attempts = 3, .ahead = 0};
inline SchedulerOptions without_endgame() {
  SchedulerOptions options = kPlain;
  options.endgame = false;
  return options;
}

}  // namespace tessera
