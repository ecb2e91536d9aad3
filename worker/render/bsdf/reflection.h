// SPDX-License-Identifier: Apache-2.0
// Reflection by a mirror, by a rough surface of GGX facets, and by Phong's cosine lobe. Directions are local.
#pragma once

#include "worker/render/bsdf/fresnel.h"
#include "worker/render/bsdf/lobe.h"
#include "worker/render/bsdf/microfacet.h"

namespace tessera::tracer {

inline Color fresnel(const Lobe& l, float cosine) {
  switch (l.fresnel) {
    case Lobe::Fresnel::schlick:
      return schlick(cosine, l.f0);
    case Lobe::Fresnel::conductor:
      return conductor_fresnel(cosine, l.eta, l.k);
    case Lobe::Fresnel::dielectric: {
      const float r = dielectric_fresnel(cosine, l.ior).reflectance;
      return {r, r, r};
    }
    case Lobe::Fresnel::none:
      break;
  }
  return {1, 1, 1};
}

inline Vec3 mirror_direction(const Vec3& wo) { return {-wo.x, -wo.y, wo.z}; }

inline LobeValue reflection_value(const Lobe& l, const Vec3& wo, const Vec3& wi) {
  const Vec3 h = unit(wo + wi);
  return {l.color * fresnel(l, dot(wo, h)) * microfacet_value(wo, wi, h, l.alpha),
          visible_reflection_pdf(wo, h, l.alpha)};
}

// (n + 2) / (2 pi) cos^n of the angle to the mirror direction; Lafortune and Willems 1994, "Using the
// Modified Phong Reflectance Model for Physically Based Rendering". The power goes by the chord to the mirror
// direction, for cosines near 1 have no digits left: cosine = 1 - chord^2 / 2.
inline LobeValue phong_value(const Lobe& l, const Vec3& wo, const Vec3& wi) {
  const Vec3 chord = wi - mirror_direction(wo);
  const float versine = 0.5f * dot(chord, chord);
  if (!(versine < 1)) return {};
  const float power = std::exp(l.alpha * std::log1p(-versine)) * (0.5f * kInvPi);
  const float cosine = dot(wo, unit(wo + wi));
  return {l.color * fresnel(l, cosine) * ((l.alpha + 2) * power * wi.z), (l.alpha + 1) * power};
}

// Density (n + 1) / (2 pi) cos^n about the mirror direction; may lie below the surface.
inline Vec3 phong_direction(const Lobe& l, const Vec3& wo, const Vec2& u) {
  const Vec2 d = disc(u);
  const float radius2 = std::min(d.x * d.x + d.y * d.y, 1.0f - 0x1p-24f);
  const float versine = -std::expm1(std::log1p(-radius2) / (l.alpha + 1));
  const float scale = radius2 > 0 ? root(versine * (2.0f - versine) / radius2) : 0.0f;
  return Frame(mirror_direction(wo)).to_world({d.x * scale, d.y * scale, 1.0f - versine});
}

// The GGX alpha that is about as wide; Walter et al. 2007, "Microfacet Models for Refraction through Rough
// Surfaces", section 5.2.
inline float phong_exponent(float alpha) { return std::max(2.0f / (alpha * alpha) - 2.0f, 0.0f); }

}  // namespace tessera::tracer
