// SPDX-License-Identifier: Apache-2.0
// Cones of directions, as bounds of the way that lights face. Only cosines are kept.
#pragma once

#include "worker/render/vector_math.h"

namespace tessera::tracer {

inline float sine_of(float cosine) { return root(1.0f - cosine * cosine); }

// cos(max(0, a - b)) for angles in [0, pi].
inline float cos_less(float cos_a, float sin_a, float cos_b, float sin_b) {
  return cos_a >= cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
}

// All unit vectors within an angle of `axis`; a cosine of -1: all there are.
struct Cone {
  Vec3 axis{0, 0, 1};
  float cosine = -1;
};

// The smallest cone about both.
inline Cone joined(const Cone& a, const Cone& b) {
  const auto angle = [](float cosine) { return std::acos(std::clamp(cosine, -1.0f, 1.0f)); };
  const float wide_a = angle(a.cosine), wide_b = angle(b.cosine), apart = angle(dot(a.axis, b.axis));
  if (apart + wide_b <= wide_a) return a;
  if (apart + wide_a <= wide_b) return b;
  const float wide = (wide_a + apart + wide_b) / 2;
  const Vec3 side = b.axis - a.axis * dot(a.axis, b.axis);
  if (wide >= kPi || !(dot(side, side) > 0)) return {a.axis, -1};
  const float turn = wide - wide_a;
  return {unit(a.axis * std::cos(turn) + unit(side) * std::sin(turn)), std::cos(wide)};
}

}  // namespace tessera::tracer
