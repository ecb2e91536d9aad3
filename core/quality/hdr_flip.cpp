// SPDX-License-Identifier: Apache-2.0
#include "core/quality/hdr_flip.h"

#include <algorithm>
#include <cmath>

#include "core/quality/color_space.h"

namespace tessera {
namespace {

// (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5); the factors of 0.6 are the pre-exposure of the fit.
constexpr double kK0 = 0.6 * 0.6 * 2.51, kK1 = 0.6 * 0.03, kK3 = 0.6 * 0.6 * 2.43, kK4 = 0.6 * 0.59,
                 kK5 = 0.14;

// The light that is tone-mapped to `t`: the positive root.
double light_of(double t) {
  const double a = kK0 - t * kK3, b = kK1 - t * kK4, c = -t * kK5;
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

std::vector<float> positive_luminances(const Image& rgb) {
  std::vector<float> values;
  for (std::size_t i = 0; i < rgb.plane(0).size(); ++i) {
    float y = 0;
    for (int c = 0; c < 3; ++c) y += static_cast<float>(kXyzOfRgb[1][c]) * std::max(rgb.plane(c)[i], 0.0f);
    if (y > 0 && std::isfinite(y)) values.push_back(y);
  }
  return values;
}

double median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (double{*middle} + *std::max_element(values.begin(), middle));
}

Image exposed(const Image& linear, double exposure) {
  Image out(linear.region(), 3);
  const double scale = std::exp2(exposure);  // may be beyond a float, what it makes of dim pixels is not
  for (int c = 0; c < 3; ++c)
    std::ranges::transform(linear.plane(c), out.plane(c).begin(),
                           [&](float v) { return tone_mapped(static_cast<float>(scale * v)); });
  return out;
}

}  // namespace

Exposures flip_exposures(const Image& reference) {
  const std::vector<float> y = positive_luminances(reference);
  if (y.empty()) return {};
  const double light = light_of(0.85);
  Exposures e{std::log2(light / *std::ranges::max_element(y)), std::log2(light / median(y)), 2};
  e.count = std::max(2, static_cast<int>(std::ceil(e.stop - e.start)));
  return e;
}

float tone_mapped(float linear) {
  constexpr float k0 = kK0, k1 = kK1, k3 = kK3, k4 = kK4, k5 = kK5;
  // Beyond 1e6 the fit is above 1 to the last bit; squares must not overflow.
  const float v = std::clamp(linear, 0.0f, 1e6f);
  return std::clamp((k0 * v * v + k1 * v) / (k3 * v * v + k4 * v + k5), 0.0f, 1.0f);
}

ErrorMap hdr_flip_map(const Image& x, const Image& r, const FlipKernels& kernels,
                      const Exposures& exposures) {
  ErrorMap worst;
  for (int i = 0; i < exposures.count; ++i) {
    ErrorMap one = flip_map(exposed(x, exposures.at(i)), exposed(r, exposures.at(i)), kernels);
    if (worst.values.empty()) {
      worst = std::move(one);
      continue;
    }
    for (std::size_t p = 0; p < worst.values.size(); ++p)
      if (!(one.values[p] <= worst.values[p])) worst.values[p] = one.values[p];
  }
  return worst;
}

}  // namespace tessera
