// SPDX-License-Identifier: Apache-2.0
// A job that is not over, as the farm holds it in memory.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/coordinator.h"
#include "coordinator/store/records.h"

namespace tessera {

class FarmKeeper;

// Of memory, while its frames are worked on: as many as are at the same time, each as large as the largest.
double bytes_of(const Submission&);

struct OpenJob {
  JobRecord record;
  Submission submission;
  double bytes = 0;         // of memory that its frames take while they are worked on
  std::uint64_t stamp = 1;  // see JobDetail

  // From here on only of one that was begun in this life.
  std::optional<ShotId> shot;          // being worked on
  std::vector<Job> jobs;               // of all frames
  std::vector<std::string> keys;       // of their images; of those that have ended, as they came to be
  std::vector<std::size_t> places;     // of the shot's frames in the job
  std::vector<FrameRecord> frames;     // all
  std::shared_ptr<FarmKeeper> keeper;  // of the shot
  Instant begun{};
  double seconds_before = 0;                 // in earlier lives
  std::uint64_t samples_before = 0;          // of frames that have ended
  std::size_t writing = 0;                   // frames that have ended, whose files are not there yet
  std::optional<std::string> limit_reached;  // which, and so it is being ended
};

bool has_ended(const FrameRecord&);

// What is left to do of a job's frames: their places, and of those that go by a history that is there, its
// blob (empty: by none, as the frame before has failed).
struct StillToDo {
  std::vector<std::size_t> places;  // ascending, or in the order of submission if none goes by another
  std::map<std::size_t, Digest> histories;  // by indices into `places`
};
StillToDo still_to_do(const std::vector<Job>& jobs, const std::vector<FrameRecord>& frames);

}  // namespace tessera
