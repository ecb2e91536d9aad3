// SPDX-License-Identifier: Apache-2.0
// Non-local means of a whole picture, pair by pair.
#pragma once

#include <functional>
#include <vector>

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image nlm(const FilterPlan&, const Image& input);

// One signal over a picture, row by row, and the variance of each of its pixels.
struct Signal {
  std::vector<double> value, variance;
};

// The window and patches of a non-local mean, and the pixels that take part.
struct NlmWindow {
  Region picture;
  int radius = 0, patch = 0;
  std::function<bool(int, int)> valid;  // of coordinates anywhere
};

// Lardinoije's prefilter: weights are the means over patches of exp(-(v - v')^2 / (epsilon + V + V')).
std::vector<double> nlm_mean_of_exp(const NlmWindow&, const Signal&, double epsilon);

}  // namespace tessera::reference
