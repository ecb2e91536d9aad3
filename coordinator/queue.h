// SPDX-License-Identifier: Apache-2.0
// Which of a farm's jobs are worked on. Pure: no pixels, tasks or time.
//
// A job waits until those it comes after are completed, then until the farm has room for it: memory for its
// frames, and workers that would run dry, or a higher priority than all that are active. Of those that may
// begin, the highest priority does; of equal ones, that of the owner who has the fewest active; of equal
// ones, the first that was submitted. Once active, tasks are shared out by the scheduler.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/submission.h"
#include "proto/questions.h"

namespace tessera {

struct QueuedJob {
  std::uint64_t number = 0;  // in order of submission
  JobName job;
  std::string owner;
  int priority = 50;
  std::vector<JobName> after;
  double bytes = 0;  // of memory that its frames take while it is active
  JobState state = JobState::queued;
  bool begun = false;  // it holds memory: it was active, and has not ended
};

// What is free.
struct FarmRoom {
  double bytes = 0;     // of memory
  bool hungry = false;  // workers have nothing to do, or will soon
};

class Queue {
 public:
  // Precondition: no job of that name is there.
  void add(QueuedJob job);
  const QueuedJob* find(const JobName& job) const;
  // The job that should begin now.
  std::optional<JobName> next(const FarmRoom& room) const;
  // Those that can never begin, as one they come after has failed, was cancelled, or is not known; and why.
  std::map<JobName, std::string> hopeless() const;
  // Why it waits; empty: it does not.
  std::string waits_for(const JobName& job) const;

  void begin(const JobName& job);
  void pause(const JobName& job);   // whatever is not over
  void resume(const JobName& job);  // whatever is paused
  void set_priority(const JobName& job, int priority);
  void end(const JobName& job, JobState how);  // completed, failed or cancelled
  void forget(const JobName& job);             // that is over; no other comes after it

 private:
  bool ready(const QueuedJob& job) const;

  std::map<JobName, QueuedJob> jobs_;
  std::map<std::uint64_t, JobName> open_;  // jobs that are not over, by number
};

bool is_over(JobState state);

}  // namespace tessera
