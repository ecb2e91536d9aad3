// SPDX-License-Identifier: Apache-2.0
#include "core/quality/estimate.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

constexpr int kBlockEdge = 8;

// Sum of the products with the weights over a block, and its pixels.
struct BlockSum {
  double sum = 0, area = 0;
};

// `row(c, y, x0, x1)` adds up the errors of channel c from x0 to x1 of row y.
template <typename Row>
std::vector<BlockSum> block_sums(const Region& cell, const Row& row) {
  std::vector<BlockSum> blocks;
  for (const Region& block : grid_cells(cell, {kBlockEdge, kBlockEdge})) {
    BlockSum s{0, static_cast<double>(block.area())};
    for (int c = 0; c < 3; ++c)
      for (int y = block.y0; y < block.y1; ++y) s.sum += row(c, y, block.x0, block.x1);
    s.sum /= 3;
    blocks.push_back(s);
  }
  return blocks;
}

// The 95 % quantile of Student's t over that of the normal distribution, within 0.03 above one degree of
// freedom.
double student_factor(double degrees) { return 1.0 + 0.93 / (degrees - 0.67); }

// Mean over pixels, and the delete-one-block jackknife error of it for blocks of unequal size (Busing et al.
// 1999), which for a mean is  var = 1/g sum_j (m_j - mean)^2 / (h_j - 1),  m_j the mean of block j, h_j the
// ratio of all pixels to its pixels. Widened to Student's t for few blocks. The error is never taken below
// |mean| for less than four blocks, and is |mean| for a single one: nothing is known then.
ErrorEstimate jackknife(const std::vector<BlockSum>& blocks) {
  double sum = 0, area = 0;
  for (const BlockSum& b : blocks) sum += b.sum, area += b.area;
  const double mean = sum / area, count = static_cast<double>(blocks.size());
  if (!std::isfinite(mean)) return {std::numeric_limits<double>::infinity(), 0};
  double variance = 0;
  for (const BlockSum& b : blocks) {
    const double rest = area / b.area - 1, away = b.sum / b.area - mean;
    if (rest > 0) variance += away * away / rest / count;
  }
  double error = std::sqrt(variance);
  if (count > 1) error *= student_factor(count - 1);
  if (count < 4) error = std::max(error, std::abs(mean));
  return {mean, error};
}

}  // namespace

// r is the mean of Y over 9x9 pixels. Y itself will not do: a pixel that is too bright by chance would get a
// small weight and hide its own error; and in a wide window dark pixels beside bright ones count too little,
// bright ones beside dark ones too much. Ratio of mean estimate to mean true relMSE over 36 simulated cells
// (hit-or-miss noise, edges, textures, a lamp in the dark; self-weighted bilateral filter; the last three
// rows with a firefly in 100,000 samples) for several r, from the table in docs/METRICS.md:
//     relMSE   truth  Y     3x3   5x5   9x9   17x17
//     0.1459   1.01  0.68  1.53  1.79  1.98  2.13
//     0.0390   1.01  0.92  1.25  1.32  1.38  1.46
//     0.0102   0.99  0.98  1.07  1.10  1.13  1.20
//     0.0029   1.00  0.99  1.04  1.07  1.10  1.17
//     0.1032   0.99  0.35  0.60  0.87  1.06  1.15
//     0.0273   0.99  0.41  0.84  0.97  1.03  1.05
//     0.0079   0.98  0.62  0.96  0.99  1.01  1.02
// The excess is noise that survives in Y: on the safe side, and small at errors that are accepted. 9x9 is the
// smallest of these windows that is never below the truth-weighted estimate.
Image relative_weight(const Image& y, const Region& cell) {
  const Region wide = intersect(grown(cell, kWeightRadius), y.region());
  assert(wide.contains(cell) && y.planes() >= 3);
  Image weight(cell, 3);
  for (int c = 0; c < 3; ++c) {
    // Taps from left to right, then from top to bottom; outside the frame there are none.
    Image rows({cell.x0, wide.y0, cell.x1, wide.y1}, 1);
    for (int v = wide.y0; v < wide.y1; ++v) {
      const float* from = y.row(c, v).data() - y.region().x0;
      float* to = rows.row(0, v).data() - cell.x0;
      for (int tap = -kWeightRadius; tap <= kWeightRadius; ++tap) {
        const int begin = std::max(cell.x0, wide.x0 - tap), end = std::min(cell.x1, wide.x1 - tap);
        for (int x = begin; x < end; ++x) to[x] += from[x + tap];
      }
    }
    for (int v = cell.y0; v < cell.y1; ++v) {
      float* to = weight.row(c, v).data() - cell.x0;
      const int top = std::max(v - kWeightRadius, wide.y0), bottom = std::min(v + kWeightRadius + 1, wide.y1);
      for (int tap = top; tap < bottom; ++tap) {
        const float* from = rows.row(0, tap).data() - cell.x0;
        for (int x = cell.x0; x < cell.x1; ++x) to[x] += from[x];
      }
      for (int x = cell.x0; x < cell.x1; ++x) {
        const int left = std::max(x - kWeightRadius, wide.x0),
                  right = std::min(x + kWeightRadius + 1, wide.x1);
        const float blur = to[x] / static_cast<float>((right - left) * (bottom - top));
        const float r = std::max(0.0f, blur);
        to[x] = 1.0f / (r * r + static_cast<float>(kRelMseEpsilon));
      }
    }
  }
  return weight;
}

ErrorEstimate estimate_from_halves(const HalfImages& h, const Image& weight, const Region& cell) {
  return jackknife(block_sums(cell, [&](int c, int y, int x0, int x1) {
    double sum = 0;
    for (int x = x0; x < x1; ++x) {
      const double xa = h.x_a.at(c, x, y), xb = h.x_b.at(c, x, y);
      const double bias = (h.a.at(c, x, y) - xa) * (h.b.at(c, x, y) - xb);
      sum += weight.at(c, x, y) * (bias + 0.25 * (xa - xb) * (xa - xb));
    }
    return sum;
  }));
}

ErrorEstimate estimate_from_hold_out(const Image& delivered, const Image& c1, const Image& c2,
                                     const Image& weight, const Region& cell) {
  return jackknife(block_sums(cell, [&](int c, int y, int x0, int x1) {
    double sum = 0;
    for (int x = x0; x < x1; ++x) {
      const double d = delivered.at(c, x, y);
      sum += weight.at(c, x, y) * (d - c1.at(c, x, y)) * (d - c2.at(c, x, y));
    }
    return sum;
  }));
}

ErrorEstimate pooled(const std::vector<ErrorEstimate>& estimates, const std::vector<double>& areas) {
  assert(estimates.size() == areas.size() && !areas.empty());
  double sum = 0, variance = 0, area = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double error = areas[i] * estimates[i].standard_error;
    sum += areas[i] * estimates[i].mean;
    variance += error * error;
    area += areas[i];
  }
  return {sum / area, std::sqrt(variance) / area};
}

}  // namespace tessera
