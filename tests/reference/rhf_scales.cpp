// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/rhf_scales.h"

#include <algorithm>
#include <cmath>

namespace tessera::reference {
namespace {

// Calls visit(weight, x, y) for the pixels of `fine` that count in the low-pass about (x, y), by a factor of
// 2^levels.
template <typename Visit>
void low_pass(const RhfPicture& fine, int x, int y, int levels, const Visit& visit) {
  const double sigma = 0.55 * std::sqrt(std::pow(4, levels) - 1);
  const int far = static_cast<int>(std::ceil(sigma * std::sqrt(4 * std::log(10))));
  for (int j = -far; j <= far; ++j)
    for (int i = -far; i <= far; ++i)
      if (fine.counts(x + i, y + j)) visit(std::exp(-(i * i + j * j) / (2 * sigma * sigma)), x + i, y + j);
}

// Keys, a = -1/2.
double bicubic(double t) {
  constexpr double a = -0.5;
  t = std::abs(t);
  if (t <= 1) return (a + 2) * t * t * t - (a + 3) * t * t + 1;
  if (t < 2) return a * (t * t * t - 5 * t * t + 8 * t - 4);
  return 0;
}

// Reflected at the ends of [begin, end), where the first and the last pixel come twice.
int reflected(int v, int begin, int end) {
  const int period = 2 * (end - begin), from = ((v - begin) % period + period) % period;
  return begin + std::min(from, period - 1 - from);
}

Rgb interpolated(const RhfPicture& coarse, const std::vector<Rgb>& values, double x, double y) {
  Rgb sum{};
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  for (int j = top - 1; j <= top + 2; ++j)
    for (int i = left - 1; i <= left + 2; ++i) {
      const Region& r = coarse.region;
      const Rgb& value = values[coarse.index(reflected(i, r.x0, r.x1), reflected(j, r.y0, r.y1))];
      for (int c = 0; c < 3; ++c) sum[c] += bicubic(x - i) * bicubic(y - j) * value[c];
    }
  return sum;
}

}  // namespace

RhfPicture finest_scale(const FilterPlan& plan, const Image& input) {
  const Features f(plan, input);
  RhfPicture scale{0, input.region(), {}};
  for (int y = scale.region.y0; y < scale.region.y1; ++y)
    for (int x = scale.region.x0; x < scale.region.x1; ++x) {
      RhfPixel p{.valid = f.valid(x, y), .samples = f.samples(x, y), .color = f.rgb(Aov::color, x, y)};
      for (int k = 0; k < RhfPixel::bins; ++k) p.counts[k] = p.samples * f.at(Aov::histogram, k, x, y);
      if (f.has(Aov::albedo)) p.albedo = f.rgb(Aov::albedo, x, y);
      if (f.has(Aov::normal)) p.normal = f.rgb(Aov::normal, x, y);
      scale.pixels.push_back(p);
    }
  return scale;
}

RhfPicture coarser_scale(const RhfPicture& finest, int level) {
  const double step = std::pow(2, level);
  const auto down = [&](int v) { return static_cast<int>(std::floor(v / step)); };
  const auto up = [&](int v) { return static_cast<int>(std::ceil(v / step)); };
  const Region &f = finest.region, r{down(f.x0), down(f.y0), up(f.x1), up(f.y1)};
  RhfPicture scale{level, r, {}};
  const double more = static_cast<double>(f.area()) / static_cast<double>(r.area());
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      RhfPixel sum;
      double all = 0;
      low_pass(finest, x << level, y << level, level, [&](double w, int i, int j) {
        const RhfPixel& p = finest.at(i, j);
        all += w;
        sum.samples += w * p.samples;
        for (int k = 0; k < RhfPixel::bins; ++k) sum.counts[k] += w * p.counts[k];
        for (int c = 0; c < 3; ++c) {
          sum.color[c] += w * p.color[c];
          sum.albedo[c] += w * p.albedo[c];
          sum.normal[c] += w * p.normal[c];
        }
      });
      sum.valid = all > 0;
      const auto divide = [&](double& v, double by) { v = all > 0 ? v / by : 0; };
      divide(sum.samples, all / more);
      for (double& count : sum.counts) divide(count, all / more);
      for (Rgb* rgb : {&sum.color, &sum.albedo, &sum.normal})
        for (double& v : *rgb) divide(v, all);
      scale.pixels.push_back(sum);
    }
  return scale;
}

std::vector<Rgb> merged_into(const RhfPicture& fine, const std::vector<Rgb>& filtered,
                             const RhfPicture& coarse, const std::vector<Rgb>& merged) {
  // 0 where one of both has nothing.
  std::vector<Rgb> upper(merged.size()), lower(merged.size());
  const Region &c = coarse.region, &r = fine.region;
  for (int y = c.y0; y < c.y1; ++y)
    for (int x = c.x0; x < c.x1; ++x) {
      double all = 0;
      Rgb sum{};
      low_pass(fine, 2 * x, 2 * y, 1, [&](double w, int i, int j) {
        all += w;
        for (int k = 0; k < 3; ++k) sum[k] += w * filtered[fine.index(i, j)][k];
      });
      if (all == 0 || !coarse.counts(x, y)) continue;
      upper[coarse.index(x, y)] = merged[coarse.index(x, y)];
      for (int k = 0; k < 3; ++k) lower[coarse.index(x, y)][k] = sum[k] / all;
    }
  std::vector<Rgb> result = filtered;
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      if (!fine.counts(x, y)) continue;
      const Rgb up = interpolated(coarse, upper, x / 2.0, y / 2.0),
                down = interpolated(coarse, lower, x / 2.0, y / 2.0);
      for (int k = 0; k < 3; ++k) result[fine.index(x, y)][k] += up[k] - down[k];
    }
  return result;
}

}  // namespace tessera::reference
