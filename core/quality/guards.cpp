// SPDX-License-Identifier: Apache-2.0
#include "core/quality/guards.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/quality/metrics.h"

namespace tessera {
namespace {

constexpr int kBlockEdge = 8;

// The samples of one half of one pixel.
struct Samples {
  float n = 0, hits = 0;
  std::array<float, 3> sum{}, square{};

  double mean(int c) const { return n > 0 ? double{sum[c]} / n : 0; }
  // Sum of squared distances from the mean.
  double scatter(int c) const { return n > 0 ? std::max(0.0, square[c] - double{sum[c]} * sum[c] / n) : 0; }
  double variance_of_mean(int c) const { return n > 1 ? scatter(c) / ((double{n} - 1) * n) : 0; }
  double luminance() const { return (mean(0) + mean(1) + mean(2)) / 3; }
};
using Halves = std::array<Samples, 2>;

// The pixels of a cell, row by row.
struct CellSamples {
  Region cell;
  std::vector<Halves> pixels;

  const Halves& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y - cell.y0) * cell.width() + (x - cell.x0)];
  }
};

CellSamples samples_of(const Image& sums, const FilmLayout& layout, const Region& cell) {
  CellSamples s{cell, std::vector<Halves>(static_cast<std::size_t>(cell.area()))};
  std::size_t i = 0;
  for (int y = cell.y0; y < cell.y1; ++y)
    for (int x = cell.x0; x < cell.x1; ++x, ++i)
      for (const Half h : {Half::a, Half::b}) {
        Samples& p = s.pixels[i][static_cast<int>(h)];
        p.n = sums.at(FilmLayout::count(h), x, y);
        p.hits = sums.at(FilmLayout::hits(h), x, y);
        for (int c = 0; c < 3; ++c) {
          p.sum[c] = sums.at(layout.sum(Aov::color, c, h), x, y);
          p.square[c] = sums.at(layout.square(Aov::color, c, h), x, y);
        }
      }
  return s;
}

// The share of `half`'s energy in the given pixels.
double share_in(const CellSamples& s, const std::vector<std::size_t>& chosen, int half) {
  double all = 0, in = 0;
  for (const Halves& p : s.pixels) all += std::max(0.0, p[half].luminance());
  for (std::size_t i : chosen) in += std::max(0.0, s.pixels[i][half].luminance());
  return all > 0 ? in / all : 0;
}

// Over half of a half's energy lies in its brightest 1 % of the pixels, and the other half has less than half
// of that there. Lamps pass, as both halves see them. Misses fireflies that are brighter than their
// surroundings but not than all of them together.
bool energy_is_concentrated(const CellSamples& s) {
  std::vector<std::size_t> order(s.pixels.size());
  const std::size_t top = std::max<std::size_t>(1, order.size() / 100);
  for (int half = 0; half < 2; ++half) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto brighter = [&](std::size_t i, std::size_t j) {
      const double a = s.pixels[i][half].luminance(), b = s.pixels[j][half].luminance();
      return a != b ? a > b : i < j;
    };
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(top - 1), order.end(),
                     brighter);
    const std::vector<std::size_t> chosen(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(top));
    const double share = share_in(s, chosen, half);
    if (share > 0.5 && share_in(s, chosen, 1 - half) < 0.5 * share) return true;
  }
  return false;
}

// What the differences A - B of a cell look like.
struct Tails {
  double count = 0, second = 0, fourth = 0;  // moments, in units of the expected deviation
  int outliers = 0;                          // pixel channels beyond ten deviations
  double worst = 0;                          // relMSE of the whole cell that one of them made, unfiltered

  double kurtosis() const { return second > 0 ? fourth * count / (second * second) : 0; }
};

void add_block(Tails& tails, const CellSamples& s, const Region& block, int c) {
  const double pixels = static_cast<double>(block.area());
  std::array<double, 2> variance{}, mean{};
  for (int y = block.y0; y < block.y1; ++y)
    for (int x = block.x0; x < block.x1; ++x)
      for (int h = 0; h < 2; ++h) {
        variance[h] += s.at(x, y)[h].variance_of_mean(c) / pixels;
        mean[h] += s.at(x, y)[h].mean(c) / pixels;
      }
  const double common = std::min(variance[0], variance[1]), level = std::min(mean[0], mean[1]);
  const double weight = 1 / (level * level + kRelMseEpsilon) / static_cast<double>(s.cell.area());
  for (int y = block.y0; y < block.y1; ++y)
    for (int x = block.x0; x < block.x1; ++x) {
      const Halves& p = s.at(x, y);
      const double own = std::min(p[0].variance_of_mean(c), p[1].variance_of_mean(c));
      const double unit = 2 * std::max(own, common), away = p[0].mean(c) - p[1].mean(c);
      if (unit <= 0) continue;
      const double square = away * away / unit;
      tails.count += 1;
      tails.second += square;
      tails.fourth += square * square;
      if (square <= 100) continue;
      ++tails.outliers;
      tails.worst = std::max(tails.worst, weight * away * away / 4);
    }
}

// The kurtosis of A - B in units of its expected deviation is above 30, it is made by fewer than 8 outliers,
// so that nobody knows how many more there are to come, and one more could lift the cell above the target. A
// pixel's own variance cannot be the unit: a lone bright sample enters it as much as the mean, and the ratio
// is never above 1. The unit is the smaller of the halves' variances, which the lone sample is in only one
// of, and at least that of its 8x8 block, as a pixel may have seen no variation yet. One outlier of about 19
// deviations in 4096 pixels reaches 30; Gaussian noise has 3. Misses tails that no sample has come from, and
// outliers in both halves of a pixel.
bool tails_are_heavy(const CellSamples& s, double target) {
  Tails tails;
  for (const Region& block : grid_cells(s.cell, {kBlockEdge, kBlockEdge}))
    for (int c = 0; c < 3; ++c) add_block(tails, s, block, c);
  return tails.kurtosis() > 30 && tails.outliers < 3 * 8 && tails.worst > target;
}

// A sample lies at most sqrt((n - 1) / n * scatter) from the mean of its n (Samuelson 1968). Were that one
// sample missed, would the cell's mean, in units of sqrt(mean^2 + epsilon) as relMSE counts, move by more
// than the square root of the target? Misses what many moderate outliers do together.
bool one_sample_decides(const CellSamples& s, double target) {
  double all = 0, samples = 0, most = 0;
  for (const Halves& p : s.pixels)
    for (const Samples& h : p) {
      all += h.luminance() * h.n;
      samples += h.n;
      double away = 0;
      for (int c = 0; c < 3; ++c) away += h.n > 1 ? std::sqrt((h.n - 1) / h.n * h.scatter(c)) / 3 : 0;
      most = std::max(most, away);
    }
  if (samples <= 0) return true;
  const double mean = all / samples;
  return most / samples > std::sqrt(target * (mean * mean + kRelMseEpsilon));
}

// Some 8x8 block has fewer than 16 samples that carried light: at least (sum x)^2 / sum x^2 of them did
// (Cauchy-Schwarz). Pixels behind which there is nothing, and that are black, are known to be. A block that
// is black after 64 samples a pixel is believed. Misses light that finds a block more rarely than that.
bool block_is_dark(const CellSamples& s, const Region& block) {
  double carried = 0, samples = 0;
  int lit_or_solid = 0;
  for (int y = block.y0; y < block.y1; ++y)
    for (int x = block.x0; x < block.x1; ++x) {
      const Halves& p = s.at(x, y);
      double most = 0;
      for (int c = 0; c < 3; ++c) {
        const double sum = double{p[0].sum[c]} + p[1].sum[c];
        const double square = double{p[0].square[c]} + p[1].square[c];
        if (square > 0) most = std::max(most, sum * sum / square);
      }
      carried += most;
      samples += p[0].n + p[1].n;
      if (most > 0 || p[0].hits + p[1].hits > 0) ++lit_or_solid;
    }
  const double pixels = static_cast<double>(block.area());
  if (carried == 0 && samples >= 64 * pixels) return false;
  return carried < 16.0 * lit_or_solid / (kBlockEdge * kBlockEdge);
}

bool is_too_dark(const CellSamples& s) {
  const std::vector<Region> blocks = grid_cells(s.cell, {kBlockEdge, kBlockEdge});
  return std::ranges::any_of(blocks, [&](const Region& block) { return block_is_dark(s, block); });
}

}  // namespace

std::string_view to_string(Guard guard) {
  switch (guard) {
    case Guard::none:
      return "none";
    case Guard::concentrated_energy:
      return "concentrated_energy";
    case Guard::heavy_tails:
      return "heavy_tails";
    case Guard::single_sample:
      return "single_sample";
    case Guard::too_dark:
      return "too_dark";
  }
  return "";
}

Guard guard_of(const Image& sums, const FilmLayout& layout, const Region& cell, double target) {
  assert(sums.region().contains(cell) && !cell.empty() && layout.aovs().has(Aov::color));
  const CellSamples s = samples_of(sums, layout, cell);
  if (energy_is_concentrated(s)) return Guard::concentrated_energy;
  if (tails_are_heavy(s, target)) return Guard::heavy_tails;
  if (one_sample_decides(s, target)) return Guard::single_sample;
  if (is_too_dark(s)) return Guard::too_dark;
  return Guard::none;
}

}  // namespace tessera
