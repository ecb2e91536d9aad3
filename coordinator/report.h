// SPDX-License-Identifier: Apache-2.0
// What a coordinator tells of its frames: how they stand, how they ended.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/frame.h"
#include "coordinator/progress.h"
#include "core/instant.h"

namespace tessera {

// How a job ended, or stands.
struct JobReport {
  FrameImage image;
  double seconds = 0;
  std::uint64_t dropped = 0;             // samples that were not finite
  std::set<std::string> device_classes;  // of the workers whose results are in
  std::vector<float> errors;             // relMSE of the frame at each look
  std::optional<std::string> failure;    // set: the job failed, for this reason
  bool bad_input = false;                // and the reason is the scene or the job itself
  std::shared_ptr<const Image> kept;     // for the next frame, see Frame::kept(); null: nothing
  bool continued = false;                // it went by what the frame before has kept
};

struct JobWatcher {
  ProgressSink progress = {};  // called whenever something changed, but not more often than
  Millis interval{0};          // this
  // Called after request_snapshot(), for each frame under way: its place in the shot, and how it stands.
  std::function<void(std::size_t frame, const JobReport&)> snapshot = {};
  // Called when a frame has ended; workers go on meanwhile. Frames may end out of order, unless each needs
  // what the one before has kept.
  std::function<void(std::size_t frame, JobReport)> finished = {};
  // What happened that somebody may want to know later: failed tasks, lost workers. One line.
  std::function<void(std::size_t frame, const std::string&)> noted = {};
};

}  // namespace tessera
