// SPDX-License-Identifier: Apache-2.0
// The filters with kernels, and each of their variants: what every one of them is tested for.
#pragma once

#include <limits>
#include <string_view>
#include <vector>

namespace tessera {

// Values that are farther from the reference than a bound says: which part of all may be, and how far, as a
// part of the value and of the picture's largest.
struct Strays {
  double share = 0, relative = 0, of_largest = 0;
};

struct FilterCase {
  std::string_view text;
  // Largest relative difference from the scalar reference; with light of many decades.
  double relative = 1e-4, extreme = 1e-3;
  // What a value may differ beyond that, as a part of the picture's largest: of sums whose terms cancel, the
  // error is a part of the terms.
  double of_largest = 0;
  // The same for pictures with fireflies. Squared errors as large as a firefly's leave no digits to tell
  // others apart: a choice by them is then a choice by rounding.
  double firefly = 0;
  Strays of_fireflies, of_extremes, of_denormals;
  // Squares of its light must fit into a float: compared are 24 decades, of 60 only the bounds are kept.
  bool squares = false;
  // How far below 0 a value may be, in units of the largest light that comes in.
  double below = 0;
  // On denormal inputs, what numbers may differ that were below the smallest normal one on the way, and count
  // as 0: a variance is divided by squared albedos, 1e-6 and more, and there are some terms of a sum.
  double flushed = 1e7 * std::numeric_limits<float>::min();
  // Largest relative change of a constant picture; 0: not a bit.
  double constant = 0;
  // Takes depth, so that sky passes through and is no pixel's neighbour; a pixel that is not finite likewise.
  bool parts_sky = true;
  // Commutes with a turn of the picture by 180 degrees.
  bool turns = true;
  // Of its history: takes from nine pixels where the four around say nothing; ends with temporal
  // anti-aliasing.
  bool wide_past = true, taa = false;
  // What is computed costs so much that tests take smaller pictures.
  bool slow = false;
};

const std::vector<FilterCase>& filter_cases();

}  // namespace tessera
