// SPDX-License-Identifier: Apache-2.0
// How good a filter was on a scene at a number of samples, by every metric, and tables of that.
#pragma once

#include <string>
#include <vector>

#include "core/image.h"

namespace tessera::quality {

struct Scores {
  std::string scene, filter;  // filter: "noisy" for the samples' mean itself
  int samples = 0;
  double milliseconds = 0;
  double relmse = 0, relmse_trimmed = 0;  // linear; the reference's own variance is subtracted from the first
  double rmse = 0, mse0 = 0, ssim = 0, flip = 0, lightness = 0, luv = 0;  // of the display image (gamma 2.2)
};

// All of `scores` but the names, samples and time. `variance`: of the reference's pixels.
void score(const Image& image, const Image& reference, const Image& variance, Scores& scores);

// One row a score.
std::string csv(const std::vector<Scores>&);

// Markdown: what the papers' tables show, on these scenes, and everything else filter by filter.
std::string report(const std::vector<Scores>&);

}  // namespace tessera::quality
