// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/bmfr.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "core/filter/blocks.h"
#include "tests/reference/features.h"

namespace tessera::reference {
namespace {

constexpr int kColumns = 10;  // 1, normal, position, squared position
using Row = std::array<double, kColumns>;
using Place = std::pair<int, int>;

int quotient(int a, int b) { return static_cast<int>(std::floor(static_cast<double>(a) / b)); }

int mirrored(int i, int begin, int end) {
  while (i < begin || i >= end) i = i < begin ? 2 * begin - 1 - i : 2 * end - 1 - i;
  return i;
}

std::uint32_t pcg(std::uint32_t v) {
  const std::uint32_t state = v * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

// Least squares by Gaussian elimination of the normal equations; rows of a hold three right-hand sides.
std::array<Rgb, kColumns> solved(std::array<std::array<double, kColumns + 3>, kColumns> a) {
  for (int k = 0; k < kColumns; ++k) {
    int pivot = k;
    for (int i = k + 1; i < kColumns; ++i)
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    std::swap(a[k], a[pivot]);
    for (int i = 0; i < kColumns; ++i) {
      if (i == k) continue;
      const double f = a[i][k] / a[k][k];
      for (int j = k; j < kColumns + 3; ++j) a[i][j] -= f * a[k][j];
    }
  }
  std::array<Rgb, kColumns> x;
  for (int k = 0; k < kColumns; ++k)
    for (int c = 0; c < 3; ++c) x[k][c] = a[k][kColumns + c] / a[k][k];
  return x;
}

class Bmfr {
 public:
  Bmfr(const FilterPlan& plan, const Image& input)
      : plan_(plan), f_(plan, input), grid_(block_grid(plan)), stochastic_(plan["regularisation"] == 1) {}

  const Features& features() const { return f_; }

  // Light at a valid pixel: the mean of the grids' fits, weighted by the distances to their blocks' borders.
  Rgb light(int x, int y) {
    double sum = 0;
    Rgb total{};
    constexpr Place kHalves[] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
    for (int g = 0; g < static_cast<int>(plan_["grids"]); ++g) {
      const int ox = grid_.x + kHalves[g].first * grid_.cell(),
                oy = grid_.y + kHalves[g].second * grid_.cell();
      const Place corner{ox + grid_.edge * quotient(x - ox, grid_.edge),
                         oy + grid_.edge * quotient(y - oy, grid_.edge)};
      const double w = tent(x - corner.first) * tent(y - corner.second);
      const Rgb fit = fit_of(corner).at(features_of(x, y));
      sum += w;
      for (int c = 0; c < 3; ++c) total[c] += w * fit[c];
    }
    for (double& v : total) v = std::max(0.0, v / sum);
    return total;
  }

 private:
  using Raw = std::array<double, 6>;  // normal, position
  struct Fit {
    Raw low{}, high{};
    std::array<Rgb, kColumns> coefficients{};

    // Positions and their squares in a basis in which the block reaches from -1 to 1.
    Row row(const Raw& raw) const {
      Row t{1, raw[0], raw[1], raw[2]};
      for (int c = 0; c < 3; ++c) {
        const double extent = (high[3 + c] - low[3 + c]) / 2, middle = (high[3 + c] + low[3 + c]) / 2;
        t[4 + c] = extent > 0 ? (raw[3 + c] - middle) / extent : 0;
        t[7 + c] = t[4 + c] * t[4 + c];
      }
      return t;
    }
    Rgb at(const Raw& raw) const {
      Rgb sum{};
      const Row t = row(raw);
      for (int k = 0; k < kColumns; ++k)
        for (int c = 0; c < 3; ++c) sum[c] += t[k] * coefficients[k][c];
      return sum;
    }
  };

  double tent(int i) const { return std::min(i, grid_.edge - 1 - i) + 0.5; }

  Raw features_of(int x, int y) const {
    Raw raw;
    for (int c = 0; c < 3; ++c)
      raw[c] = f_.at(Aov::normal, c, x, y), raw[3 + c] = f_.at(Aov::position, c, x, y);
    return raw;
  }

  Place source(int x, int y) const {
    const Region& r = f_.region();
    return {mirrored(x, r.x0, r.x1), mirrored(y, r.y0, r.y1)};
  }

  // Demodulated light of a cell's pixels, row by row, luminance twice clamped to mean + k deviations.
  const std::vector<Rgb>& clamped(Place corner) {
    const auto [entry, fresh] = cells_.try_emplace(corner);
    std::vector<Rgb>& cell = entry->second;
    if (!fresh) return cell;
    std::vector<Rgb*> valid;
    cell.resize(static_cast<std::size_t>(grid_.cell()) * grid_.cell());
    for (int j = 0, k = 0; j < grid_.cell(); ++j)
      for (int i = 0; i < grid_.cell(); ++i, ++k) {
        const auto [x, y] = source(corner.first + i, corner.second + j);
        if (!f_.valid(x, y)) continue;
        const Rgb lit = difference(f_.rgb(Aov::color, x, y), f_.rgb(Aov::emission, x, y));
        const Rgb albedo = floored(f_.rgb(Aov::albedo, x, y));
        cell[k] = {lit[0] / albedo[0], lit[1] / albedo[1], lit[2] / albedo[2]};
        valid.push_back(&cell[k]);
      }
    for (int round = 0; round < 2; ++round) {
      double mean = 0, variance = 0;
      for (const Rgb* c : valid) mean += luminance(*c) / static_cast<double>(valid.size());
      for (const Rgb* c : valid)
        variance += std::pow(luminance(*c) - mean, 2) / static_cast<double>(valid.size());
      const double limit = std::max(0.0, mean + plan_["clamp"] * std::sqrt(variance));
      for (Rgb* c : valid)
        if (const double l = luminance(*c); l > limit)
          for (double& v : *c) v *= limit / l;
    }
    return cell;
  }

  // Equal for all blocks.
  double noise(int column, int i, int j) const {
    const int frame = static_cast<int>(plan_["frame"]);
    const std::uint32_t key = ((frame * 16u + column) * grid_.edge + j) * grid_.edge + i;
    return plan_["epsilon"] * (2.0 * (pcg(key) >> 8) / (1 << 24) - 1);
  }

  const Fit& fit_of(Place corner) {
    const auto [entry, fresh] = fits_.try_emplace(corner);
    Fit& fit = entry->second;
    if (!fresh) return fit;
    struct Pixel {
      int i, j;
      Raw raw;
      Rgb light;
    };
    std::vector<Pixel> pixels;
    fit.low.fill(INFINITY);
    fit.high.fill(-INFINITY);
    const int edge = grid_.edge, half = grid_.cell();
    for (int j = 0; j < edge; ++j)
      for (int i = 0; i < edge; ++i) {
        const auto [x, y] = source(corner.first + i, corner.second + j);
        if (!f_.valid(x, y)) continue;
        const auto& cell = clamped({corner.first + i / half * half, corner.second + j / half * half});
        pixels.push_back({i, j, features_of(x, y), cell[j % half * half + i % half]});
        for (int k = 0; k < 6; ++k) {
          fit.low[k] = std::min(fit.low[k], pixels.back().raw[k]);
          fit.high[k] = std::max(fit.high[k], pixels.back().raw[k]);
        }
      }
    std::array<std::array<double, kColumns + 3>, kColumns> sums{};
    for (const Pixel& p : pixels) {
      Row t = fit.row(p.raw);
      for (int a = 1; a < kColumns; ++a) t[a] += stochastic_ ? noise(a, p.i, p.j) : 0;
      for (int a = 0; a < kColumns; ++a) {
        for (int b = 0; b < kColumns; ++b) sums[a][b] += t[a] * t[b];
        for (int c = 0; c < 3; ++c) sums[a][kColumns + c] += t[a] * p.light[c];
      }
    }
    const double count = static_cast<double>(pixels.size());
    if (stochastic_ && count < 2 * kColumns) {
      for (int c = 0; c < 3; ++c) fit.coefficients[0][c] = sums[0][kColumns + c] / count;
      return fit;
    }
    if (!stochastic_)
      for (int a = 1; a < kColumns; ++a) sums[a][a] += count * std::pow(plan_["epsilon"], 2) / 3;
    fit.coefficients = solved(sums);
    return fit;
  }

  const FilterPlan& plan_;
  Features f_;
  BlockGrid grid_;
  bool stochastic_;
  std::map<Place, std::vector<Rgb>> cells_;  // by their first pixel
  std::map<Place, Fit> fits_;
};

}  // namespace

Image bmfr(const FilterPlan& plan, const Image& input) {
  Bmfr bmfr(plan, input);
  const Features& f = bmfr.features();
  const Region& r = input.region();
  Image out(r, 3);
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      const bool valid = f.valid(x, y);
      const Rgb light = valid ? bmfr.light(x, y) : Rgb{}, albedo = floored(f.rgb(Aov::albedo, x, y));
      for (int k = 0; k < 3; ++k) {
        const double color = f.at(Aov::color, k, x, y);
        out.at(k, x, y) = static_cast<float>(valid ? light[k] * albedo[k] + f.at(Aov::emission, k, x, y)
                                             : std::isfinite(color) ? color
                                                                    : 0.0);
      }
    }
  return out;
}

}  // namespace tessera::reference
