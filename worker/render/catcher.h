// SPDX-License-Identifier: Apache-2.0
// Shadow catchers: surfaces of which the camera sees only how much of their light something takes away.
#pragma once

#include <optional>

#include "worker/render/light/lights.h"

namespace tessera::tracer {

// One way along which a surface point gets light, chosen with the probability of its share of the irradiance
// if nothing were in between: so it is free with the probability (irradiance) / (irradiance without shadows).
struct LightWay {
  Vec3 direction;
  Vec3 target;  // unless infinite
  bool infinite;
};

// By resampled importance sampling (Talbot et al. 2005) among kCandidates ways to lights and as many cosine
// distributed directions to the sky: exact only in the limit of many candidates. `random(i)` is the i-th pair
// of numbers in [0, 1)^2 of this choice. Nothing if no light reaches the point even without shadows.
inline constexpr int kCatcherCandidates = 8;

template <class Random>
std::optional<LightWay> choose_light_way(const Lights& lights, const Vec3& position, const Vec3& normal,
                                         float time, const Random& random);

}  // namespace tessera::tracer

#include "worker/render/warp.h"

namespace tessera::tracer {

// Keeps one of a stream, each with the probability of its share of the weights (Chao 1982).
class Reservoir {
 public:
  explicit Reservoir(float u) : u_(u) {}

  void offer(const LightWay& way, float weight) {
    if (!(weight > 0)) return;
    sum_ += weight;
    const float chance = weight / sum_;
    if (u_ < chance) {
      kept_ = way;
      u_ /= chance;
    } else {
      u_ = (u_ - chance) / (1 - chance);
    }
  }
  const std::optional<LightWay>& kept() const { return kept_; }

 private:
  float u_, sum_ = 0;
  std::optional<LightWay> kept_;
};

template <class Random>
std::optional<LightWay> choose_light_way(const Lights& lights, const Vec3& position, const Vec3& normal,
                                         float time, const Random& random) {
  Reservoir reservoir(random(0).x);
  const Frame frame(normal);
  for (int i = 0; i < kCatcherCandidates; ++i) {
    if (!lights.empty()) {
      const LightSample s = lights.sample(position, normal, random(3 * i + 1).x, random(3 * i + 2), time);
      const float cosine = dot(s.direction, normal);
      if (s.pdf > 0 && cosine > 0) {
        // The sky is found by both kinds of candidates, all else by this one only.
        const float share = s.infinite && !s.delta ? power_heuristic(s.pdf, cosine * kInvPi) : 1.0f;
        reservoir.offer({s.direction, s.target, s.infinite}, luminance(s.radiance) * cosine * share / s.pdf);
      }
    }
    const Vec3 local = cosine_hemisphere(random(3 * i + 3));
    const Vec3 direction = frame.to_world(local);
    float sky = 0;
    lights.escaped({position, normal, local.z * kInvPi}, direction,
                   [&](const Emitted& e) { sky += luminance(e.radiance); });
    reservoir.offer({direction, {}, true}, sky * kPi);
  }
  return reservoir.kept();
}

}  // namespace tessera::tracer
