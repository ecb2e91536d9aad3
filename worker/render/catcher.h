// SPDX-License-Identifier: Apache-2.0
// Shadow catchers: surfaces of which the camera sees only how much of their light something takes away.
#pragma once

#include "worker/render/bvh.h"
#include "worker/render/light/lights.h"
#include "worker/render/warp.h"

namespace tessera::tracer {

// Ways along which a surface point may get light, half of them to lights and half cosine distributed to the
// sky, and the luminance of the irradiance that each stands for if nothing is in between.
class LightWays {
 public:
  // `random(i)` is the i-th pair of numbers in [0, 1)^2 of this choice.
  template <class Random>
  LightWays(const Lights& lights, const Vec3& position, const Vec3& normal, float time, const Random& random);

  // Sends a shadow ray along each from `origin(direction)`. The share of the light that comes through; 1 if
  // there is none. A ratio of two estimates: exact only in the limit of many ways.
  template <class Origin>
  float share_let_through(const Bvh& bvh, const RayTraits& traits, const Origin& origin) const;

 private:
  struct Way {
    Vec3 direction;
    Vec3 target;  // unless infinite
    bool infinite;
    float light = 0;
  };
  std::array<Way, kLanes> ways_;
};

template <class Random>
LightWays::LightWays(const Lights& lights, const Vec3& position, const Vec3& normal, float time,
                     const Random& random) {
  const Frame frame(normal);
  for (int i = 0; i < kLanes; i += 2) {
    Way& lamp = ways_[static_cast<std::size_t>(i)];
    if (!lights.empty()) {
      const LightSample s = lights.sample(position, normal, random(2 * i).x, random(2 * i + 1), time);
      const float cosine = dot(s.direction, normal);
      lamp = {s.direction, s.target, s.infinite};
      // The sky is found by both kinds of ways, all else by this one only.
      const float share = s.infinite && !s.delta ? power_heuristic(s.pdf, cosine * kInvPi) : 1.0f;
      if (s.pdf > 0 && cosine > 0) lamp.light = luminance(s.radiance) * cosine * share / s.pdf;
    }
    Way& sky = ways_[static_cast<std::size_t>(i + 1)];
    const Vec3 local = cosine_hemisphere(random(2 * i + 2));
    sky = {frame.to_world(local), Vec3(0, 0, 0), true};
    lights.escaped({position, normal, local.z * kInvPi}, sky.direction,
                   [&](const Emitted& e) { sky.light += luminance(e.radiance) * kPi; });
  }
}

template <class Origin>
float LightWays::share_let_through(const Bvh& bvh, const RayTraits& traits, const Origin& origin) const {
  ShadowPacket rays;
  float all = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    const Way& way = ways_[static_cast<std::size_t>(lane)];
    rays.active[lane] = 0;
    if (!(way.light > 0)) continue;
    const Vec3 from = origin(way.direction);
    way.infinite ? rays.set(lane, from, way.direction, kFar, traits)
                 : rays.set(lane, from, way.target - from, 1, traits);
    all += way.light;
  }
  if (!(all > 0)) return 1;
  bvh.occluded(rays);
  float through = 0;
  for (int lane = 0; lane < kLanes; ++lane)
    if (rays.active[lane] != 0 && !rays.occluded(lane))
      through += ways_[static_cast<std::size_t>(lane)].light;
  return through / all;
}

}  // namespace tessera::tracer
