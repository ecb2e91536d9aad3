// SPDX-License-Identifier: Apache-2.0
#include "core/quality/display.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/scene/srgb.h"

namespace tessera {
namespace {

template <typename F>
Image each_value(const Image& linear, float exposure, const F& f) {
  assert(linear.planes() >= 3);
  Image out(linear.region(), 3);
  const float scale = std::exp2(exposure);
  for (int c = 0; c < 3; ++c)
    std::ranges::transform(linear.plane(c), out.plane(c).begin(),
                           [&](float v) { return f(std::clamp(v * scale, 0.0f, 1.0f)); });
  return out;
}

float to_gamma(float v) { return std::pow(v, 1.0f / 2.2f); }

}  // namespace

std::string to_string(Curve curve) { return curve == Curve::srgb ? "sRGB" : "gamma 2.2"; }

Image displayed(const Image& linear, const Display& display) {
  return display.curve == Curve::srgb ? each_value(linear, display.exposure, to_srgb)
                                      : each_value(linear, display.exposure, to_gamma);
}

Image screen_light(const Image& linear, const Display& display) {
  if (display.curve == Curve::srgb) return each_value(linear, display.exposure, [](float v) { return v; });
  return each_value(linear, display.exposure, [](float v) { return from_srgb(to_gamma(v)); });
}

}  // namespace tessera
