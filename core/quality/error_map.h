// SPDX-License-Identifier: Apache-2.0
// The error of every pixel, whatever the metric, and what is made of it: means, percentiles, cells. Nothing
// is skipped: a value that is not finite makes everything made of it not finite.
#pragma once

#include <vector>

#include "core/image.h"

namespace tessera {

struct ErrorMap {
  Region region;               // may be empty
  std::vector<double> values;  // row by row
};

double mean(const ErrorMap&);  // NaN if there are no pixels

// Without the worst 0.1 % of the pixels (rounded down); NaN if any pixel is not finite.
double trimmed_mean(const ErrorMap&);

// The smallest value that at least `share` of the pixels do not exceed; NaN if any is NaN.
double percentile(const ErrorMap&, double share);

// The value below which half of the error lies: each pixel weighs as much as its error (Andersson et al.
// 2020, section 6), which must not be negative. 0 if there is no error, NaN if any pixel is not finite.
double weighted_median(const ErrorMap&);

double largest(const ErrorMap&);  // NaN if any is NaN

struct CellErrors {
  Region cell;
  double mean = 0, percentile_99 = 0;
  double worst_block = 0;  // largest mean of the aligned blocks of 8 x 8 pixels
};
// Of each aligned cell of the global grid, left to right, top to bottom.
std::vector<CellErrors> by_cells(const ErrorMap&, int edge = kCellEdge);

Image image_of(const ErrorMap&);  // one plane

}  // namespace tessera
