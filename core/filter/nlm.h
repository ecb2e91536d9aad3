// SPDX-License-Identifier: Apache-2.0
// Non-local means as a part of filters: the shape of a run of the kernels nlm (worker/denoise/kernels/nlm.cl)
// and nlm_mean_of_exp (nlm_prefilter.cl), and what one costs.
#pragma once

#include "core/filter/filter.h"

namespace tessera {

struct NlmShape {
  int radius = 0;    // of the window
  int patch = 0;     // radius of the patches
  int channels = 1;  // whose distances are averaged
  int halves = 1;    // 2: weights of either filter the other

  int reach() const { return radius + patch; }
  int offsets() const { return (2 * radius + 1) * (2 * radius + 1) - 1; }
};

// Tiles in which the kernels work, and the offsets they take at a time: tables of all their sums stay in a
// core's second cache, the group's rows in the first.
inline constexpr int kNlmColumns = 128, kNlmRows = 64, kNlmGroup = 3;
// Scratch that tiles take by their size: they may be half as large as they are meant to be, or end in a
// vector's rest.
inline constexpr double kUneven = 1.6;
// Rows that each offset has beside its tables at most: rings of 16 and their sums, for two maps.
inline constexpr int kNlmRowsBeside = 2 * (2 * 16 + 1) + 1;

// Of the filter nlm with these parameters.
NlmShape nlm_shape(const ParameterValues&);

// Of the prefilter of fdf.
NlmShape fdf_prefilter_shape(const ParameterValues&);

// Of a pixel, in the kernels' inner loops: exponential of the mean distance, mean of the exponentials.
double nlm_flops(const NlmShape&);
double nlm_mean_of_exp_flops(const NlmShape&);
// Of a tile's own copy: of either half u and V of each channel, and which pixels count
// (kernels/nlm_common.cl). The mean of exponentials has 4, one more.
constexpr int nlm_planes(const NlmShape& s) { return 2 * s.halves * s.channels + 2; }
// Floats of tables a pixel takes at most.
double nlm_scratch(const NlmShape&);

}  // namespace tessera
