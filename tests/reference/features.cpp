// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/features.h"

#include <algorithm>
#include <cmath>

namespace tessera::reference {

Features::Features(const FilterPlan& plan, const Image& input) : input_(input), inputs_(plan.inputs()) {
  for (auto& of_aov : first_plane_)
    for (auto& of_statistic : of_aov) std::ranges::fill(of_statistic, -1);
  int plane = 0;
  for (const Channel& c : inputs_) {
    if (c.index == 0)
      first_plane_[static_cast<int>(c.aov)][static_cast<int>(c.statistic)][static_cast<int>(c.share)] = plane;
    ++plane;
  }
  for (int y = region().y0; y < region().y1; ++y)
    for (int x = region().x0; x < region().x1; ++x) {
      valid_.push_back(finite_and_no_sky(x, y));
      if (has(Aov::normal)) normals_.push_back(direction(rgb(Aov::normal, x, y)));
    }
}

namespace {

// Where it is no number, there is no past.
bool tells_of_the_past(Aov a) { return info(a).reduction == Reduction::point; }

}  // namespace

bool Features::finite_and_no_sky(int x, int y) const {
  if (has(Aov::depth) && at(Aov::depth, 0, x, y) >= kSkyDepth) return false;
  for (int k = 0; k < input_.planes(); ++k)
    if (!tells_of_the_past(inputs_[k].aov) && !std::isfinite(input_.at(k, x, y))) return false;
  return true;
}

Rgb Features::direction(const Rgb& n) const {
  const double length = std::sqrt(squared(n));
  if (length < 1e-6) return {0, 0, 0};
  return {n[0] / length, n[1] / length, n[2] / length};
}

double luminance(const Rgb& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }
double squared(const Rgb& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }
Rgb difference(const Rgb& a, const Rgb& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Rgb floored(const Rgb& a) { return {std::max(a[0], 1e-3), std::max(a[1], 1e-3), std::max(a[2], 1e-3)}; }

double b3(int offset) {
  constexpr double weights[] = {3.0 / 8, 1.0 / 4, 1.0 / 16};
  return weights[std::abs(offset)];
}

}  // namespace tessera::reference
