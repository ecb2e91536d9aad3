// SPDX-License-Identifier: Apache-2.0
// How good a filter was on each frame of a shot, and how long its kernels took.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "bench/judging/trial.h"
#include "bench/temporal/contestants.h"
#include "core/quality/temporal.h"

namespace tessera::temporal {

struct FrameScores {
  std::string scene, group, filter;
  int frame = 0;
  // Of the display image, gamma 2.2. The reference's own noise is not in the RMSE: it is the root of the mean
  // of (x - a) (x - b), where a and b are independent halves of the reference. It is in all others.
  double rmse = 0, ssim = 0;
  // See core/quality/temporal.h; none of the first frame.
  double error = std::numeric_limits<double>::quiet_NaN(), reference_error = error, residual = error;
  double reference_noise = 0;  // RMSE that the reference itself has: half of that of a against b
  double milliseconds = 0;     // of all kernels
};

// Of a kernel on a shot.
struct KernelScores {
  std::string scene, filter, kernel;
  double milliseconds = 0;  // of a frame, all its runs: the median of the frames
};

struct Results {
  int samples = 1, reference_samples = 0, frames = 0;
  Size size;
  std::vector<Contestant> contestants;
  std::vector<FrameScores> frames_scores;
  std::vector<KernelScores> kernels;
};

// Fills in what pictures tell. `stability`: of the same filter, of the frames before.
void score(const Image& image, const judging::Reference& reference, TemporalError& stability,
           FrameScores& scores);

std::string frames_csv(const Results&);
std::string kernels_csv(const Results&);

// Markdown: the tables of the papers, on these scenes.
std::string report(const Results&);

// SCENE_rmse.png and the like: each filter's line over the frames; and over what a group varies.
void write_plots(const Results&, const std::filesystem::path& folder);

}  // namespace tessera::temporal
