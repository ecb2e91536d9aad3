// SPDX-License-Identifier: Apache-2.0
// Numbers of the rays of a packet side by side, one a lane, as the processor's widest vectors hold them. Each
// lane is computed by itself: what is in the others does not show in it.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "worker/render/vector_math.h"

namespace tessera::tracer {

inline constexpr int kLanes = 16;  // rays of a packet: one 4x4 block of pixels

using Wide = float __attribute__((vector_size(sizeof(float) * kLanes)));
using WideInt = std::int32_t __attribute__((vector_size(sizeof(std::int32_t) * kLanes)));
using Mask = WideInt;  // of each lane: -1 or 0

inline Wide wide(float x) { return x - Wide{}; }
inline WideInt wide(std::int32_t x) { return x - WideInt{}; }

// From and to arrays of kLanes numbers.
inline Wide load(const float* from) {
  Wide w;
  std::memcpy(&w, from, sizeof w);
  return w;
}
template <typename W, typename Number>
void store(const W& w, Number* to) {
  static_assert(sizeof(Number) * kLanes == sizeof w);
  std::memcpy(to, &w, sizeof w);
}

// A bit a lane.
inline std::uint32_t bits(const Mask& m) {
  std::int32_t lane[kLanes];
  store(m, lane);
  std::uint32_t all = 0;
  for (int i = 0; i < kLanes; ++i) all |= static_cast<std::uint32_t>(lane[i] & (1 << i));
  return all;
}
inline bool any(const Mask& m) { return bits(m) != 0; }

// Calls do_lane(lane) for each lane that is in the mask, in their order.
template <typename Do>
void each_lane(const Mask& m, const Do& do_lane) {
  for (std::uint32_t left = bits(m); left != 0; left &= left - 1) do_lane(std::countr_zero(left));
}

inline Wide square(const Wide& x) { return x * x; }
inline Wide absolute(const Wide& x) { return std::bit_cast<Wide>(std::bit_cast<WideInt>(x) & 0x7fffffff); }
inline Wide greater(const Wide& a, const Wide& b) { return a > b ? a : b; }
inline Wide smaller(const Wide& a, const Wide& b) { return a < b ? a : b; }
// Of what is negative: 0.
inline Wide root(const Wide& x) {
  float lane[kLanes];
  store(greater(x, Wide{}), lane);
  for (float& l : lane) l = std::sqrt(l);
  return load(lane);
}

struct Wide2 {
  Wide x, y;
};

// Vectors or colours, one a lane.
struct Wide3 {
  Wide x, y, z;

  Vec3 at(int lane) const { return {x[lane], y[lane], z[lane]}; }
  void set(int lane, const Vec3& v) {
    x[lane] = v.x;
    y[lane] = v.y;
    z[lane] = v.z;
  }
};

inline Wide3 wide(const Vec3& v) { return {wide(v.x), wide(v.y), wide(v.z)}; }
inline Wide3 operator+(const Wide3& a, const Wide3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Wide3 operator-(const Wide3& a, const Wide3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Wide3 operator-(const Wide3& a) { return {-a.x, -a.y, -a.z}; }
inline Wide3 operator*(const Wide3& a, const Wide3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Wide3 operator*(const Wide3& a, const Wide& s) { return {a.x * s, a.y * s, a.z * s}; }
inline Wide3 operator*(const Wide3& a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline Wide dot(const Wide3& a, const Wide3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Wide max_component(const Wide3& c) { return greater(greater(c.x, c.y), c.z); }
inline Wide luminance(const Wide3& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
inline Mask is_black(const Wide3& c) { return (c.x == 0) & (c.y == 0) & (c.z == 0); }

// Lanes of `a` where the mask says so, else of `b`.
inline Wide chosen(const Mask& m, const Wide& a, const Wide& b) { return m ? a : b; }
inline Wide3 chosen(const Mask& m, const Wide3& a, const Wide3& b) {
  return {m ? a.x : b.x, m ? a.y : b.y, m ? a.z : b.z};
}

inline Wide3 cross(const Wide3& a, const Wide3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Wide3 unit_or(const Wide3& v, const Wide3& otherwise) {
  const Wide largest = greater(greater(absolute(v.x), absolute(v.y)), absolute(v.z));
  const Wide3 scaled = v * (1.0f / largest);
  return chosen(largest > 0, scaled * (1.0f / root(dot(scaled, scaled))), otherwise);
}

// As Frame, one a lane.
struct WideFrame {
  Wide3 x, y, z;

  explicit WideFrame(const Wide3& normal) : z(normal) {
    const WideInt sign_bit = std::bit_cast<WideInt>(normal.z) & std::bit_cast<std::int32_t>(-0.0f);
    const Wide sign = std::bit_cast<Wide>(sign_bit | std::bit_cast<std::int32_t>(1.0f));
    const Wide a = -1.0f / (sign + normal.z);
    const Wide b = normal.x * normal.y * a;
    x = {1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
    y = {b, sign + normal.y * normal.y * a, -normal.y};
  }
  Wide3 to_world(const Wide3& v) const {
    return {x.x * v.x + y.x * v.y + z.x * v.z, x.y * v.x + y.y * v.y + z.y * v.z,
            x.z * v.x + y.z * v.y + z.z * v.z};
  }
};

}  // namespace tessera::tracer
