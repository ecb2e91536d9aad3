// SPDX-License-Identifier: Apache-2.0
// How much of a texture a ray cone covers where it hits a surface: Akenine-Moeller et al. 2019, "Texture
// Level of Detail Strategies for Real-Time Ray Tracing" (Ray Tracing Gems, chapter 20).
#pragma once

#include "worker/render/geometry.h"

namespace tessera::tracer {

// Texture coordinates per metre on a surface that shows `uv_area` of a texture on `area` square metres: the
// square root of their ratio, as if the texture were stretched alike in all directions (there, equation 4,
// without the logarithm). 0, the finest level, where there is no area.
inline float uv_per_metre(float uv_area, float area) {
  const float ratio = std::abs(uv_area) / area;
  return area > 0 && std::isfinite(ratio) ? std::sqrt(ratio) : 0.0f;
}

// Of a sphere: the whole picture on the whole surface.
inline float uv_per_metre(const Sphere& s) { return uv_per_metre(1, 4 * kPi * square(s.radius)); }

inline float uv_per_metre(const Quad& q) { return uv_per_metre(1, length(cross(q.edge_u, q.edge_v))); }

// A disk shows the square around it.
inline float uv_per_metre(const Disk& d) { return uv_per_metre(1, 4 * square(d.radius)); }

inline float shape_uv_per_metre(const Geometry& geometry, const Hit& hit) {
  const Scene& scene = geometry.scene();
  switch (geometry.pieces[hit.piece].kind) {
    case Piece::Kind::spheres:
      return uv_per_metre(scene.spheres[geometry.shape(hit)]);
    case Piece::Kind::quads:
      return uv_per_metre(scene.quads[geometry.shape(hit)]);
    default:
      return uv_per_metre(scene.disks[geometry.shape(hit)]);
  }
}

// Of what was hit; 0 if it has no texture coordinates.
inline float uv_per_metre(const Geometry& geometry, const Hit& hit) {
  const Mesh* mesh = geometry.mesh_at(hit);
  if (!mesh) return shape_uv_per_metre(geometry, hit);
  if (mesh->uvs.empty()) return 0;
  const auto& corner = mesh->triangles[hit.primitive];
  const Vec2 a = mesh->uvs[corner[1]] - mesh->uvs[corner[0]], b = mesh->uvs[corner[2]] - mesh->uvs[corner[0]];
  return uv_per_metre(a.x * b.y - a.y * b.x, length(geometry.triangle(hit.piece, hit.primitive).normal));
}

// The diameter in texture coordinates of a cone that is `cone_width` metres wide where it hits, `cosine` off
// the surface's normal: of the circle that is as large as the cone's ellipse on the surface. (The paper takes
// the ellipse's long axis, cosine instead of its root: that blurs at grazing angles what samples within the
// pixel resolve anyway.)
inline float uv_width(float cone_width, float cosine, float uv_per_metre) {
  constexpr float kLeastCosine = 0.01f;
  return std::abs(cone_width) * uv_per_metre / std::sqrt(std::max(std::abs(cosine), kLeastCosine));
}

}  // namespace tessera::tracer
