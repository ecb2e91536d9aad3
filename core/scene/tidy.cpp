// SPDX-License-Identifier: Apache-2.0
#include "core/scene/tidy.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Vec3D = Imath::V3d;

bool usable(const Vec3& p) {
  return std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate &&
         std::abs(p.z) <= kMaxCoordinate;
}

// Twice the area, along the normal. In doubles: a thin triangle of floats is not taken for a line.
Vec3D cross_of(const Mesh& mesh, const Triangle& t) {
  const Vec3D a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
  return (b - a).cross(c - a);
}

Vec3 unit(const Vec3D& v) { return Vec3(v / std::sqrt(v.dot(v))); }

void tidy_normals(Mesh& mesh) {
  std::vector<bool> broken(mesh.normals.size());
  bool any = false;
  for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
    const Vec3D n(mesh.normals[v]);
    const double length2 = n.dot(n);
    broken[v] = !(std::isfinite(length2) && length2 > 1e-12);
    if (!broken[v] && std::abs(length2 - 1) < 5e-7)
      continue;  // as near to a unit vector as floats are: tidying twice changes nothing
    else if (!broken[v])
      mesh.normals[v] = unit(n);
    else
      mesh.normals[v] = Vec3(0, 0, 1), any = true;
  }
  if (!any) return;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (broken[v]) mesh.normals[v] = unit(cross_of(mesh, t));
}

std::size_t tidy_colors(Mesh& mesh) {
  std::size_t changed = 0;
  for (auto& color : mesh.colors) {
    const auto before = color;
    for (float& v : color) v = std::isnan(v) ? 1.0f : std::clamp(v, 0.0f, 1.0f);
    changed += color != before;
  }
  return changed;
}

}  // namespace

Tidied tidy(Mesh& mesh) {
  Tidied tidied;
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const bool garbage =
        !std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return usable(mesh.positions[v]); });
    const Vec3D cross = garbage ? Vec3D(0) : cross_of(mesh, t);
    const bool flat = !garbage && !(cross.dot(cross) > 0);
    tidied.not_finite += garbage;
    tidied.degenerate += flat;
    return garbage || flat;
  });
  for (Vec3& p : mesh.positions)
    if (!usable(p)) p = Vec3(0);
  for (auto* uvs : {&mesh.uvs, &mesh.uvs2})
    for (Vec2& uv : *uvs)
      if (!(std::abs(uv.x) <= kMaxCoordinate && std::abs(uv.y) <= kMaxCoordinate)) uv = Vec2(0);
  tidied.colors = tidy_colors(mesh);
  tidy_normals(mesh);
  return tidied;
}

}  // namespace tessera
