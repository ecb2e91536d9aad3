// SPDX-License-Identifier: Apache-2.0
// Rows of the store, as values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/sha256.h"
#include "core/submission.h"
#include "proto/frame_log.h"
#include "proto/questions.h"

namespace tessera {

struct JobRecord {
  std::uint64_t number = 0;  // in order of submission, from 1; given by Store::add
  // Fixed once it is added.
  JobName job;
  Digest submission;
  std::string name, owner;
  std::int64_t submitted = 0;  // Unix time, ms
  // Changed by Store::save.
  JobState state = JobState::queued;
  std::string reason;
  int priority = 50;
  double seconds = 0;  // since it began
  std::uint64_t pixel_samples = 0, failed_tasks = 0;
  bool operator==(const JobRecord&) const = default;
};

struct FrameRecord {
  std::uint32_t place = 0;  // in Submission::frames
  int frame = 0;            // its number
  FrameState state = FrameState::waiting;
  std::string reason;
  std::string image_key;  // see coordinator/resume.h
  Digest image, preview,
      kept;  // EXR, PNG, what the next frame goes by (store/kept_image.h); empty: not there
  int rounds = 0;
  double seconds = 0;
  std::uint64_t pixel_samples = 0;
  std::optional<double> error;  // relMSE
  double acceptable_share = 0;
  std::vector<float> errors;  // at each look
  bool operator==(const FrameRecord&) const = default;
};

// An accepted task, for doing it again elsewhere and comparing.
struct AcceptedRecord {
  std::uint64_t job = 0;  // JobRecord::number
  std::uint32_t place = 0;
  Accepted accepted;
  bool operator==(const AcceptedRecord&) const = default;
};

}  // namespace tessera
