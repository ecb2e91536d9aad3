// SPDX-License-Identifier: Apache-2.0
// The isotropic GGX distribution of microfacet normals with height-correlated Smith masking; Heitz 2014,
// "Understanding the Masking-Shadowing Function". Directions are local: +Z is the macroscopic normal.
#pragma once

#include "worker/render/warp.h"

namespace tessera::tracer {

// Density of normals per steradian of normals and area of microsurface.
inline float ggx(const Vec3& h, float alpha) {
  const float a2 = alpha * alpha;
  const float t = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;  // exact near the pole, where 1 - z^2 is not
  return 1.0f / (kPi * a2 * t * t);
}

// Smith's Lambda, Heitz 2014 eq. 72.
inline float smith_lambda(const Vec3& w, float alpha) {
  const float tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
  return 0.5f * (std::sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}

// A normal visible from `wo`; Heitz 2018, "Sampling the GGX Distribution of Visible Normals", by the
// spherical caps of Dupuy and Benyoub 2023, which have the same density.
inline Vec3 visible_normal(const Vec3& wo, float alpha, const Vec2& u) {
  const Vec3 stretched = unit({alpha * wo.x, alpha * wo.y, wo.z});
  // Uniform over the cap z in (-stretched.z, 1]: a "cone" of versine 1 + z.
  const Vec3 h = cone(u, 1.0f + stretched.z) + stretched;
  return unit({alpha * h.x, alpha * h.y, std::max(h.z, 1e-6f)});
}

// Density of visible_normal(wo) at h, reflected: per steradian of the direction `wo` is mirrored to.
inline float visible_reflection_pdf(const Vec3& wo, const Vec3& h, float alpha) {
  return ggx(h, alpha) / (4.0f * wo.z * (1.0f + smith_lambda(wo, alpha)));
}

// f * cosine of reflection by facets that reflect all; both directions above.
inline float microfacet_value(const Vec3& wo, const Vec3& wi, const Vec3& h, float alpha) {
  const float masking = 1.0f / (1.0f + smith_lambda(wo, alpha) + smith_lambda(wi, alpha));
  return ggx(h, alpha) * masking / (4.0f * wo.z);
}

}  // namespace tessera::tracer
