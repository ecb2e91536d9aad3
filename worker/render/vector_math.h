// SPDX-License-Identifier: Apache-2.0
// Arithmetic on vectors and colours that every part of the path tracer shares.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/scene/scene.h"

namespace tessera::tracer {

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;

inline float dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float square(float x) { return x * x; }
inline float length(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline Vec3 unit(const Vec3& a) { return a * (1.0f / length(a)); }
inline float root(float x) { return std::sqrt(std::max(x, 0.0f)); }

// Unit, or `otherwise` where v has no direction.
inline Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const float largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0)) return otherwise;
  return unit(v * (1.0f / largest));  // tiny triangles have normals whose square underflows
}

inline Color lerp(const Color& a, const Color& b, float t) { return a * (1.0f - t) + b * t; }
inline float max_component(const Color& c) { return std::max({c.x, c.y, c.z}); }
inline bool is_black(const Color& c) { return c.x == 0 && c.y == 0 && c.z == 0; }
inline bool is_finite(const Color& c) {
  return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z);
}
// Rec. 709.
inline float luminance(const Color& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

// An orthonormal basis around a unit vector, as in Duff et al. 2017, "Building an Orthonormal Basis,
// Revisited".
struct Frame {
  Vec3 x, y, z;

  Frame() = default;
  explicit Frame(const Vec3& normal) : z(normal) {
    const float sign = std::copysign(1.0f, normal.z);
    const float a = -1.0f / (sign + normal.z);
    const float b = normal.x * normal.y * a;
    x = {1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
    y = {b, sign + normal.y * normal.y * a, -normal.y};
  }
  Vec3 to_local(const Vec3& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
  Vec3 to_world(const Vec3& v) const {
    return {x.x * v.x + y.x * v.y + z.x * v.z, x.y * v.x + y.y * v.y + z.y * v.z,
            x.z * v.x + y.z * v.y + z.z * v.z};
  }
};

inline Vec3 reflected(const Vec3& v, const Vec3& normal) { return normal * (2.0f * dot(v, normal)) - v; }

}  // namespace tessera::tracer
