// SPDX-License-Identifier: Apache-2.0
// Random Parameter Filtering (Sen and Darabi 2012, as read by van de Vlasakker 2013) of a whole picture.
#pragma once

#include <vector>

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image rpf(const FilterPlan&, const Image& input);

// Equation 5.3, in bits, of numbers that are sorted into buckets already.
double mutual_information(const std::vector<int>& x, const std::vector<int>& y);

// What equations 5.8 to 5.16 make of the dependencies of features and colours on random parameters, on screen
// position, and of colours on features.
struct RpfDependencies {
  std::vector<double> feature_random, feature_screen, color_feature;  // of each feature
  double color_random[3] = {}, color_screen[3] = {};
};
struct RpfWeights {
  double alpha[3] = {}, contribution = 0;  // W_c^r
  std::vector<double> beta;
};
RpfWeights rpf_weights(const RpfDependencies&, double dependence);

}  // namespace tessera::reference
