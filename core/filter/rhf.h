// SPDX-License-Identifier: Apache-2.0
// How Ray Histogram Fusion parts its work: blocks of pixels whose histograms stay in the cache, and scales.
#pragma once

#include "core/aov.h"

namespace tessera {

struct RhfBlock {
  static constexpr int columns = 128;  // compared side by side, the patches' margins among them
  static constexpr int rows = 48;
  static constexpr int margin = 16;  // columns on either side that the window reaches into
  static constexpr int bins = 3 * kHistogramBins;
  // From a bin's row of histograms to the next: an odd number of cache lines, so that bins fall on different
  // cache sets.
  static constexpr int stride = columns + 2 * margin + 16;

  int radius, patch;

  int side() const { return 2 * radius + 1; }
  // Histograms of the rows that a window spans downwards, with a row more to say which bins are filled.
  int history_floats() const { return (radius + 1) * (bins + 1) * stride; }
  // Distances of all pairs, for the rows that a patch spans; a row of sums for each dx.
  int distance_floats() const {
    return (radius + 1) * side() * (2 * patch + 1) * columns + side() * columns + 32;
  }
  int floats() const { return history_floats() + distance_floats(); }
};

// A scale's pixels are every 2^level-th of the picture's, from pixel (0, 0) on, of a Gaussian low-pass of
// sigma 0.55 sqrt(4^level - 1) that is cut off at ceil(sigma sqrt(4 ln 10)).
struct RhfScale {
  static constexpr int most = 3;
  static constexpr int interpolation = 3;  // how far the bicubic reads, in pixels of the finer scale

  int level = 0;

  int step() const { return 1 << level; }
  int low_pass() const { return level == 0 ? 0 : level == 1 ? 3 : 7; }  // in pixels of the picture
};

}  // namespace tessera
