// SPDX-License-Identifier: Apache-2.0
// Lambert's law, bare and under a boundary that reflects part of the light. Directions are local.
#pragma once

#include "worker/render/bsdf/fresnel.h"
#include "worker/render/bsdf/lobe.h"

namespace tessera::tracer {

inline LobeValue lambert_value(const Lobe& l, float cosine) {
  return {l.color * (cosine * kInvPi), cosine * kInvPi};
}

// What the reflection above takes, the diffuse lobe lacks: on the way in and on the way out, as in Ashikhmin
// and Shirley 2000, "An Anisotropic Phong BRDF Model" (their section 2.2, here for a Lambertian base: 21/20
// is what Schlick's term takes from uniform light). Appendix B.3 of glTF 2.0 weighs by the half vector's
// cosine instead, which returns up to 1.05 of the light at grazing angles.
inline LobeValue coated_value(const Lobe& l, const Vec3& wo, const Vec3& wi) {
  const Color white(1, 1, 1);
  return {l.color * (white - schlick(wo.z, l.f0)) * (white - schlick(wi.z, l.f0)) * (1.05f * kInvPi * wi.z),
          wi.z * kInvPi};
}
inline Color coated_albedo(const Lobe& l, const Vec3& wo) {
  const Color white(1, 1, 1);
  return l.color * (white - l.f0) * (white - schlick(wo.z, l.f0));
}

// A Lambertian base of `reflectance` under a smooth dielectric boundary, with all reflections between the
// two: f = T(wo) T(wi) r / (pi n^2 (1 - r R)), R the boundary's reflectance of diffuse light from within, T
// what it transmits; Saunderson 1942, "Calculation of the Color of Pigmented Plastics", per direction.
// Reciprocal, and lossless for r = 1 with the reflection of the boundary. `mean` is
// mean_dielectric_fresnel(ior): by reciprocity n^2 (1 - R) = 1 - mean.
inline Lobe undercoat_lobe(const Color& reflectance, float ior, float mean) {
  const float n2 = ior * ior, within = 1.0f - (1.0f - mean) / n2;
  Lobe l{.kind = Lobe::Kind::undercoat, .ior = ior};
  for (int c = 0; c < 3; ++c) {
    const float r = std::clamp(reflectance[c], 0.0f, 1.0f);  // beyond 1 the series has no sum
    l.color[c] = r / (n2 * (1.0f - r * within));
  }
  l.f0 = Color(mean, mean, mean);
  return l;
}
inline LobeValue undercoat_value(const Lobe& l, const Vec3& wo, const Vec3& wi) {
  const float in = 1.0f - dielectric_fresnel(wi.z, l.ior).reflectance;
  const float out = 1.0f - dielectric_fresnel(wo.z, l.ior).reflectance;
  return {l.color * (in * out * wi.z * kInvPi), wi.z * kInvPi};
}
inline Color undercoat_albedo(const Lobe& l, const Vec3& wo) {
  return l.color * ((1.0f - l.f0.x) * (1.0f - dielectric_fresnel(wo.z, l.ior).reflectance));
}

}  // namespace tessera::tracer
