// SPDX-License-Identifier: Apache-2.0
// The boundary of a dielectric solid, and a thin sheet of a dielectric: smooth, or rough with GGX facets, as
// in Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces". Directions are local, wo
// above; values are of radiance, which is denser where light is slower (Veach 1997, eq. 5.2).
#pragma once

#include "worker/render/bsdf/reflection.h"

namespace tessera::tracer {

inline float boundary_reflectance(const Lobe& l, float cosine) {
  return l.kind == Lobe::Kind::sheet ? sheet_reflectance(cosine, l.ior)
                                     : dielectric_fresnel(cosine, l.ior).reflectance;
}

// Too little bending for roughness to matter: what goes through stays a single direction.
inline bool bends(float ior, float alpha) { return alpha * std::abs(ior - 1.0f) >= kSmoothAlpha; }

// Refraction by facets: eq. 21, density eq. 17 with visible normals.
inline LobeValue refraction_value(const Lobe& l, const Vec3& wo, const Vec3& wi) {
  Vec3 h = unit(wo + wi * l.ior);
  if (h.z < 0) h = -h;
  const float here = dot(wo, h), beyond = -dot(wi, h);
  if (!(here > 0 && beyond > 0)) return {};
  const float through = 1.0f - dielectric_fresnel(here, l.ior).reflectance;
  const float visible = ggx(h, l.alpha) * here / (wo.z * (1.0f + smith_lambda(wo, l.alpha)));
  const float density = through * visible * beyond / square(here - l.ior * beyond);
  return {l.color * (density / (1.0f + smith_lambda(wi, l.alpha))), density * square(l.ior)};
}

inline LobeValue dielectric_value(const Lobe& l, const Vec3& wo, const Vec3& wi) {
  if (wi.z < 0 && l.kind == Lobe::Kind::boundary) return refraction_value(l, wo, wi);
  // A sheet spreads what it lets through as what it reflects.
  const Vec3 above{wi.x, wi.y, std::abs(wi.z)};
  const Vec3 h = unit(wo + above);
  const float reflectance = boundary_reflectance(l, dot(wo, h));
  const float share = wi.z < 0 ? 1.0f - reflectance : reflectance;
  return {(wi.z < 0 ? l.color : l.f0) * (share * microfacet_value(wo, above, h, l.alpha)),
          share * visible_reflection_pdf(wo, h, l.alpha)};
}

// Where light goes, mirrored or through, by `choice` in [0, 1). The null vector where that is not on the side
// where it should be: such light is lost among the facets.
inline Vec3 dielectric_direction(const Lobe& l, const Vec3& wo, float choice, const Vec2& u) {
  const Vec3 h = l.alpha > 0 ? visible_normal(wo, l.alpha, u) : Vec3(0, 0, 1);
  const float cosine = dot(wo, h), across = 1.0f / l.ior;
  const Vec3 back = l.alpha > 0 ? reflected(wo, h) : mirror_direction(wo);
  const bool reflects = choice < boundary_reflectance(l, cosine);
  if (reflects || l.kind == Lobe::Kind::sheet) {
    if (!(back.z > 0)) return {0, 0, 0};
    return reflects ? back : Vec3(back.x, back.y, -back.z);
  }
  const float beyond = dielectric_fresnel(cosine, l.ior).cos_refracted;
  if (l.alpha == 0) return {-wo.x * across, -wo.y * across, -beyond};
  const Vec3 through = h * (cosine * across - beyond) - wo * across;
  return through.z < 0 ? through : Vec3(0, 0, 0);
}

}  // namespace tessera::tracer
