// SPDX-License-Identifier: Apache-2.0
// How much of the light a boundary reflects.
#pragma once

#include "worker/render/vector_math.h"

namespace tessera::tracer {

// Unpolarised reflectance of a dielectric boundary and the cosine of the refracted ray (0 on total
// reflection). `cosine` >= 0 is that of the incoming ray, `eta` the index beyond over the index before.
struct DielectricBoundary {
  float reflectance;
  float cos_refracted;
};
inline DielectricBoundary dielectric_fresnel(float cosine, float eta) {
  const float sin2 = (1.0f - cosine * cosine) / (eta * eta);
  if (sin2 >= 1.0f) return {1.0f, 0.0f};
  const float beyond = root(1.0f - sin2);
  const float parallel = (eta * cosine - beyond) / (eta * cosine + beyond);
  const float perpendicular = (cosine - eta * beyond) / (cosine + eta * beyond);
  return {0.5f * (parallel * parallel + perpendicular * perpendicular), beyond};
}

// Reflectance of a sheet whose sides both reflect R: with what goes to and fro within,
// R + (1 - R)^2 R / (1 - R^2) = 2 R / (1 + R); Stokes 1862, "On the Intensity of the Light Reflected from or
// Transmitted through a Pile of Plates". The rest goes through.
inline float sheet_reflectance(float cosine, float ior) {
  const float r = dielectric_fresnel(cosine, ior).reflectance;
  return 2 * r / (1 + r);
}

// Reflectance of a dielectric boundary for diffuse light from the side of index 1: the integral of
// 2 cosine R(cosine), by the midpoint rule to 1e-4.
inline float mean_dielectric_fresnel(float ior) {
  constexpr int kSteps = 128;
  float sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float cosine = (static_cast<float>(i) + 0.5f) / kSteps;
    sum += 2 * cosine * dielectric_fresnel(cosine, ior).reflectance;
  }
  return sum / kSteps;
}

// Unpolarised reflectance of a conductor in air; Born and Wolf 1999, section 14.2, solved for real numbers.
inline float conductor_fresnel(float cosine, float eta, float k) {
  const float cos2 = cosine * cosine, sin2 = 1.0f - cos2;
  const float eta2 = eta * eta, k2 = k * k;
  const float t = eta2 - k2 - sin2;
  const float ab = std::sqrt(t * t + 4 * eta2 * k2);  // a^2 + b^2, where (a + ib)^2 = (eta + ik)^2 - sin^2
  const float twice_a_cos = 2 * root(0.5f * (ab + t)) * cosine;
  const float s = (ab + cos2 - twice_a_cos) / (ab + cos2 + twice_a_cos);
  const float u = cos2 * ab + sin2 * sin2, v = twice_a_cos * sin2;
  return 0.5f * s * (1.0f + (u - v) / (u + v));
}
inline Color conductor_fresnel(float cosine, const Color& eta, const Color& k) {
  return {conductor_fresnel(cosine, eta.x, k.x), conductor_fresnel(cosine, eta.y, k.y),
          conductor_fresnel(cosine, eta.z, k.z)};
}

// Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering".
inline Color schlick(float cosine, const Color& f0) {
  const float m = 1.0f - std::min(cosine, 1.0f);
  const float m5 = m * m * m * m * m;
  return f0 + (Color(1, 1, 1) - f0) * m5;
}

}  // namespace tessera::tracer
