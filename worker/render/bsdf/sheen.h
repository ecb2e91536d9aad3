// SPDX-License-Identifier: Apache-2.0
// The sheen of fibres that stand up from a surface: KHR_materials_sheen, after Estevez and Kulla 2017,
// "Production Friendly Microfacet Sheen BRDF". Directions are local.
#pragma once

#include <array>

#include "worker/render/bsdf/lobe.h"
#include "worker/render/warp.h"

namespace tessera::tracer {

// The least alpha (roughness^2): below it the model is next to nothing but at grazing angles.
inline constexpr float kLeastSheenAlpha = 1e-3f;

// Of white sheen, without the limit that sheen_value() puts on it.
float raw_sheen_value(float alpha, const Vec3& wo, const Vec3& wi);  // f * cosine

// What white sheen scatters of light from everywhere, as a table over the cosine and the roughness. At low
// roughness and grazing angles the model is beyond 1.
class SheenAlbedo {
 public:
  SheenAlbedo();
  float operator()(float cosine, float alpha) const;

 private:
  static constexpr std::size_t kCosines = 32, kRoughnesses = 16;
  std::array<std::array<float, kCosines>, kRoughnesses> table_;
};

// The model, held to albedo 1 from both ends, so that it stays reciprocal.
inline LobeValue sheen_value(const Lobe& l, const SheenAlbedo& albedo, const Vec3& wo, const Vec3& wi) {
  const float most = std::max({1.0f, albedo(wo.z, l.alpha), albedo(wi.z, l.alpha)});
  return {l.color * (raw_sheen_value(l.alpha, wo, wi) / most), 0.5f * kInvPi};
}
inline Vec3 sheen_direction(const Vec2& u) { return cone(u, 1.0f); }

}  // namespace tessera::tracer
