// SPDX-License-Identifier: Apache-2.0
// Pearson's chi-squared test: do points of the unit square follow a density?
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "worker/render/vector_math.h"

namespace tessera::testing {

using Density = std::function<double(double x, double y)>;

inline double integral(const Density& density, double x0, double x1, double y0, double y1, int steps) {
  double sum = 0;
  for (int j = 0; j < steps; ++j)
    for (int i = 0; i < steps; ++i)
      sum += density(x0 + (x1 - x0) * (i + 0.5) / steps, y0 + (y1 - y0) * (j + 0.5) / steps);
  return sum * (x1 - x0) * (y1 - y0) / (double(steps) * steps);
}

// Checks that `points`, drawn from `drawn` tries of which the others gave no point, follow `density` (which
// integrates to the share that gives points). Fails one time in a million if they do.
inline void expect_follows(const std::vector<Vec2>& points, int drawn, const Density& density,
                           const char* what, int bins = 24, int steps = 24) {
  std::vector<double> counts(static_cast<std::size_t>(bins) * bins);
  for (const Vec2& p : points) {
    const int x = std::clamp(int(p.x * float(bins)), 0, bins - 1);
    const int y = std::clamp(int(p.y * float(bins)), 0, bins - 1);
    ++counts[static_cast<std::size_t>(y * bins + x)];
  }
  double chi2 = 0, rest = 0, rest_expected = 0, total = 0;
  int freedom = 0;
  for (int y = 0; y < bins; ++y)
    for (int x = 0; x < bins; ++x) {
      const double w = 1.0 / bins;
      const double expected = drawn * integral(density, x * w, (x + 1) * w, y * w, (y + 1) * w, steps);
      const double count = counts[static_cast<std::size_t>(y * bins + x)];
      total += expected;
      if (expected < 10) {  // too few for the statistic: pooled
        rest += count;
        rest_expected += expected;
        continue;
      }
      chi2 += (count - expected) * (count - expected) / expected;
      ++freedom;
    }
  if (rest_expected >= 10) {
    chi2 += (rest - rest_expected) * (rest - rest_expected) / rest_expected;
    ++freedom;
  } else {
    EXPECT_LT(rest, 60) << what << ": points where there should be next to none";
  }
  // The quantile of Wilson and Hilferty 1931, at 4.75 standard deviations.
  const double s = 2.0 / (9.0 * freedom);
  const double bound = freedom * std::pow(1 - s + 4.75 * std::sqrt(s), 3);
  EXPECT_LT(chi2, bound) << what << ": " << freedom << " bins";
  EXPECT_NEAR(total / drawn, double(points.size()) / drawn, 5 / std::sqrt(double(drawn)) * 0.5 + 2e-3)
      << what << ": the density's integral";
}

// Directions as points of the unit square, by equal area: a density per steradian there is 4 pi times it.
inline Vec2 on_square(const Vec3& d) {
  float phi = std::atan2(d.y, d.x) / (2 * tracer::kPi);
  if (phi < 0) phi += 1;
  return {phi, 0.5f * (d.z + 1)};
}
inline Vec3 from_square(double x, double y) {
  const double z = 2 * y - 1, r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * std::numbers::pi * x;
  return {float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
}
inline Density on_sphere(std::function<double(const Vec3&)> per_steradian) {
  return [f = std::move(per_steradian)](double x, double y) {
    return 4 * std::numbers::pi * f(from_square(x, y));
  };
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  float number() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }
  Vec2 pair() {
    const float x = number();
    return {x, number()};
  }

 private:
  std::mt19937 engine_;
};

}  // namespace tessera::testing
