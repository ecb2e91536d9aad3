// SPDX-License-Identifier: Apache-2.0
// The constants of Random Parameter Filtering, decided from a plan's parameters and preset.
#pragma once

#include <string_view>

#include "core/filter/filter.h"

namespace tessera {

inline constexpr int kRpfIterations = 4;
inline constexpr std::string_view kRpfBoxes[kRpfIterations] = {"box1", "box2", "box3", "box4"};

struct RpfIteration {
  int radius = 0;         // of the box
  double deviation = 0;   // of the draws, in pixels
  double draws = 0;       // of neighbours, for each of a pixel's samples; its own are counted in
  double dependence = 0;  // 1 + 0.1 t
};

struct RpfConstants {
  double feature = 3, position = 30;       // how many deviations a feature may be away from the pixel's mean,
  double guard = 0.1, position_guard = 0;  // and what distance may always be
  double color_factor = 1, texture_factor = 1, normal_factor = 1;  // of alpha, and of beta
  double variance = 8 * 0.02;                                      // 8 sigma_8^2
  double brightest = 1e32;                                         // of samples
  bool spikes = false;                                             // are taken out after each iteration
  int buckets = 11;
};

RpfIteration rpf_iteration(const ParameterValues&, int t);
RpfConstants rpf_constants(const ParameterValues&);

}  // namespace tessera
