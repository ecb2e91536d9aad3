// SPDX-License-Identifier: Apache-2.0
// warp.h and offset_origin(), for the rays of a packet side by side.
#pragma once

#include "worker/render/wide.h"

namespace tessera::tracer {

inline Wide2 disc(const Wide2& u) {
  const Wide a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
  const Mask wider = absolute(a) > absolute(b);
  const Wide radius = wider ? a : b, other = wider ? b : a;
  const Wide x = radius == 0 ? Wide{} : (kPi / 4) * (other / radius);
  const Wide s = x * x;
  const Wide sine = x * (1 + s * (-1.0f / 6 + s * (1.0f / 120 + s * (-1.0f / 5040 + s * (1.0f / 362880)))));
  const Wide cosine = 1 + s * (-0.5f + s * (1.0f / 24 + s * (-1.0f / 720 + s * (1.0f / 40320))));
  const Wide along = radius * cosine, across = radius * sine;
  return {wider ? along : across, wider ? across : along};
}

inline Wide3 cosine_hemisphere(const Wide2& u) {
  const Wide2 d = disc(u);
  return {d.x, d.y, root(1.0f - d.x * d.x - d.y * d.y)};
}

inline Wide3 cone(const Wide2& u, float versine) {
  const Wide2 d = disc(u);
  const Wide height = versine * smaller(wide(1.0f), d.x * d.x + d.y * d.y);
  const Wide scale = root(versine * (2.0f - height));
  return {d.x * scale, d.y * scale, 1.0f - height};
}

inline Wide power_heuristic(const Wide& a, const Wide& b) {
  return a > 0 ? 1.0f / (1.0f + square(b / a)) : Wide{};
}

inline Wide offset_along(const Wide& x, const Wide& normal) {
  constexpr float kNear = 1.0f / 32, kFloatScale = 1.0f / 65536, kIntScale = 256.0f;
  const WideInt steps = __builtin_convertvector(kIntScale * normal, WideInt);
  const WideInt far = std::bit_cast<WideInt>(x) + (x < 0 ? -steps : steps);
  return absolute(x) < kNear ? x + kFloatScale * normal : std::bit_cast<Wide>(far);
}
inline Wide3 offset_origin(const Wide3& p, const Wide3& normal) {
  return {offset_along(p.x, normal.x), offset_along(p.y, normal.y), offset_along(p.z, normal.z)};
}

}  // namespace tessera::tracer
