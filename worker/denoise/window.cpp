// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/window.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tessera {
namespace {

// Columns of a strip. With a window of 21x21 and 16 planes a strip's windows take 200 kB.
constexpr int kStrip = 128;
constexpr int kWidestVector = 16;

int pad(int radius) { return (radius + kWidestVector - 1) / kWidestVector * kWidestVector; }
int pitch(int radius) { return kStrip + 2 * pad(radius); }
int strips_over(int columns) { return (columns + kStrip - 1) / kStrip; }

}  // namespace

std::size_t window_floats(Size filtered, int radius, int planes) {
  const auto rows = static_cast<std::size_t>(strips_over(filtered.width)) * (filtered.height + 2 * radius);
  return rows * pitch(radius) * planes;
}

std::string window_options(const FilterPlan& plan, int planes) {
  const Pass pass = plan.passes().front();
  return fmt::format("-DRADIUS={} -DSTEP={} -DPLANES={} -DSTRIP={} -DPAD={} -DPITCH={}", pass.radius,
                     pass.step, planes, kStrip, pad(pass.radius), pitch(pass.radius));
}

Window window(Stage& s, int planes) {
  const int radius = s.passes().front().radius;
  const int strips = strips_over(s.inner().width()), rows = s.inner().height();
  return {s.scratch(window_floats({s.inner().width(), rows}, radius, planes)),
          {0, 0, pitch(radius), strips * (rows + 2 * radius)},
          {0, 0, kStrip, strips * rows}};
}

float exponent_over_square(double sigma) {
  return static_cast<float>(kOctave * std::numbers::log2e / (sigma * sigma));
}

float gaussian_scale(double sigma) {
  return static_cast<float>(std::sqrt(kOctave * std::numbers::log2e / 2) / sigma);
}

// Whatever the diameter, what is no sky stays finite.
float depth_scale(const FilterPlan& plan, double sigma) {
  constexpr double kMost = 1e7;
  const double diameter = plan["diameter"] > 0 ? plan["diameter"] : 1;
  return static_cast<float>(std::min(kMost, gaussian_scale(sigma) * 10 / diameter));
}

}  // namespace tessera
