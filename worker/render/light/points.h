// SPDX-License-Identifier: Apache-2.0
// Points on the shapes that emit, drawn as a point in the world sees them, and the densities of drawing them.
// Densities are per steradian at p. Of sides, visibility and radiance nothing is known here.
#pragma once

#include <optional>

#include "worker/render/geometry.h"

namespace tessera::tracer {

struct LightPoint {
  Vec3 position, normal;  // the normal is unit, on the front
  Vec2 uv;                // of a triangle: barycentric of its second and third corner; else of textures
  Vec3 direction;         // unit, from p
  float cosine;           // of the way back to p against the normal; negative: p sees the back
  float pdf;
};
using MaybePoint = std::optional<LightPoint>;  // none: p sees nothing of it

// Uniform by area.
MaybePoint sample_triangle(const Triangle& t, const Vec3& p, const Vec2& u);
inline float area_pdf(float distance2, float cosine, float area) {
  return distance2 / (std::abs(cosine) * area);
}

// From outside uniform in the cone that holds the sphere, from inside by area.
MaybePoint sample_sphere(const Sphere& sphere, const Vec3& p, const Vec2& u);
float sphere_pdf(const Sphere& sphere, const Vec3& p, float distance2, float cosine);

// A rectangle uniform by solid angle (Urena, Fajardo and King 2013, "An Area-Preserving Parametrization for
// Spherical Rectangles", sections 3 and 4); any other parallelogram, and what is tiny from p, by area.
MaybePoint sample_quad(const Quad& quad, const Vec3& p, const Vec2& u);
float quad_pdf(const Quad& quad, const Vec3& p, float distance2, float cosine);

// Uniform by area.
MaybePoint sample_disk(const Disk& disk, const Vec3& p, const Vec2& u);
float disk_pdf(const Disk& disk, float distance2, float cosine);

}  // namespace tessera::tracer
