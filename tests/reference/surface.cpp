// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/surface.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace tessera::reference {
namespace {

// Squared distance of the surface points of two pixels; nothing if either is invalid.
std::optional<double> squared_distance(const Features& f, int x, int y, int qx, int qy) {
  if (!f.valid(x, y) || !f.valid(qx, qy)) return std::nullopt;
  return squared(difference(f.rgb(Aov::position, qx, qy), f.rgb(Aov::position, x, y)));
}

double nearer(std::optional<double> a, std::optional<double> b) {
  if (a && b) return std::min(*a, *b);
  return a ? *a : b.value_or(0.0);
}

double depth(const Features& f, int x, int y) { return f.at(Aov::depth, 0, x, y); }

}  // namespace

double squared_footprint(const Features& f, int x, int y) {
  return nearer(squared_distance(f, x, y, x - 1, y), squared_distance(f, x, y, x + 1, y)) +
         nearer(squared_distance(f, x, y, x, y - 1), squared_distance(f, x, y, x, y + 1));
}

double slope(const Features& f, int x, int y, int dx, int dy) {
  double least = INFINITY;
  for (const int side : {-1, 1})
    if (f.valid(x + side * dx, y + side * dy)) {
      const double d = side * (depth(f, x + side * dx, y + side * dy) - depth(f, x, y));
      if (std::abs(d) < std::abs(least)) least = d;
    }
  return std::isfinite(least) ? least : 0;
}

double depth_exponent(const Features& f, int x, int y, int qx, int qy, double sigma_z) {
  const double plane = std::abs(slope(f, x, y, 1, 0) * (qx - x) + slope(f, x, y, 0, 1) * (qy - y));
  const double allowed = sigma_z * plane + 1e-3 * std::abs(depth(f, x, y)) + 1e-30;
  return std::abs(depth(f, qx, qy) - depth(f, x, y)) / allowed;
}

double smoothed(const Features& f, const std::vector<double>& variance, int x, int y) {
  double sum = 0, total = 0;
  each_tap(f, x, y, 1, 1, [&](int i, int j, int qx, int qy) {
    const double g = (i ? 0.25 : 0.5) * (j ? 0.25 : 0.5);
    sum += g;
    total += g * variance[f.index(qx, qy)];
  });
  return total / sum;
}

double squared_turn(const Features& f, int x, int y, int qx, int qy) {
  return squared(difference(f.unit_normal(qx, qy), f.unit_normal(x, y)));
}

}  // namespace tessera::reference
