// SPDX-License-Identifier: Apache-2.0
// Maps of the unit square to the domains that are sampled. All go through the concentric disc, so that strata
// of the square stay compact.
#pragma once

#include "worker/render/vector_math.h"

namespace tessera::tracer {

// Sine and cosine on [-pi/4, pi/4] by their Taylor series, to 4e-9: the same bits in any libm.
struct SinCos {
  float sin, cos;
};
inline SinCos sin_cos_quarter(float x) {
  const float s = x * x;
  return {x * (1 + s * (-1.0f / 6 + s * (1.0f / 120 + s * (-1.0f / 5040 + s * (1.0f / 362880))))),
          1 + s * (-0.5f + s * (1.0f / 24 + s * (-1.0f / 720 + s * (1.0f / 40320))))};
}

// Uniform on the unit disc; Shirley and Chiu 1997, "A Low Distortion Map Between Disk and Square".
inline Vec2 disc(const Vec2& u) {
  const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
  const bool wide = std::abs(a) > std::abs(b);
  const float radius = wide ? a : b;
  const float other = wide ? b : a;
  const float angle = radius == 0.0f ? 0.0f : (kPi / 4) * (other / radius);
  const SinCos sc = sin_cos_quarter(angle);
  return wide ? Vec2{radius * sc.cos, radius * sc.sin} : Vec2{radius * sc.sin, radius * sc.cos};
}

// Density cos/pi about +Z (Malley's method).
inline Vec3 cosine_hemisphere(const Vec2& u) {
  const Vec2 d = disc(u);
  return {d.x, d.y, root(1.0f - d.x * d.x - d.y * d.y)};
}

// Uniform in the cone about +Z whose half angle has 1 - cos = `versine`; density 1 / (2 pi versine). A
// versine of 2 is the whole sphere.
inline Vec3 cone(const Vec2& u, float versine) {
  const Vec2 d = disc(u);
  const float height = versine * std::min(1.0f, d.x * d.x + d.y * d.y);
  const float scale = root(versine * (2.0f - height));
  return {d.x * scale, d.y * scale, 1.0f - height};
}

// Uniform barycentric coordinates (u, v) of a triangle.
inline Vec2 triangle(const Vec2& u) {
  const float s = std::sqrt(u.x);
  return {1.0f - s, u.y * s};
}

// Power heuristic with exponent 2, of strategy `a` against `b`; Veach 1997, section 9.2.4.
inline float power_heuristic(float a, float b) { return a > 0 ? 1.0f / (1.0f + square(b / a)) : 0.0f; }

}  // namespace tessera::tracer
