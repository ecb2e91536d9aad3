// SPDX-License-Identifier: Apache-2.0
// What a farm tells of itself, once a second, to those who watch over it: a value that no longer changes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/scheduling.h"
#include "proto/questions.h"
#include "proto/zmq_transport.h"

namespace tessera {

inline constexpr std::size_t kJobStates = 6;   // of JobState
inline constexpr std::size_t kMostJobs = 256;  // that are told of one by one

struct JobFigures {  // of an active job
  JobName job;
  double fraction = 0;                  // 0..1
  std::optional<double> error, target;  // relMSE: the largest of its frames under way; what is asked for
  bool operator==(const JobFigures&) const = default;
};

// What grows counts from the coordinator's start.
struct FarmFigures {
  std::string version;
  double seconds = 0;   // since it began
  std::string trouble;  // why nothing goes on; empty: it does

  SchedulerCounts tasks;
  int slots = 0;  // of workers that are present
  std::uint64_t pixel_samples = 0;
  double samples_per_second = 0;              // pixel samples, of the last ten seconds
  std::uint64_t bytes_in = 0, bytes_out = 0;  // of pixels
  std::uint64_t failed_tasks = 0, wrong_bits = 0;

  std::array<std::uint64_t, kJobStates>
      jobs{};                      // by state: those that are not over, now; else how many ended so
  std::vector<JobFigures> active;  // kMostJobs at the most, the first that were submitted

  double memory_used = 0, memory_free = 0;  // bytes
  std::uint64_t store_bytes = 0;            // of blobs
  RouterCounts router;
};

}  // namespace tessera
