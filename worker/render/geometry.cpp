// SPDX-License-Identifier: Apache-2.0
#include "worker/render/geometry.h"

#include <bit>

namespace tessera::tracer {
namespace {

Vec3 moved(const Vec3& p, const Matrix& m) {
  return {p.x * m[0][0] + p.y * m[1][0] + p.z * m[2][0] + m[3][0],
          p.x * m[0][1] + p.y * m[1][1] + p.z * m[2][1] + m[3][1],
          p.x * m[0][2] + p.y * m[1][2] + p.z * m[2][2] + m[3][2]};
}

Vec3 turned(const Vec3& v, const Matrix& m) {
  return {v.x * m[0][0] + v.y * m[1][0] + v.z * m[2][0], v.x * m[0][1] + v.y * m[1][1] + v.z * m[2][1],
          v.x * m[0][2] + v.y * m[1][2] + v.z * m[2][2]};
}

template <typename T>
T blend(const T& a, const T& b, const T& c, float u, float v) {
  return a * (1.0f - u - v) + b * u + c * v;
}

// Unit, or `otherwise` where v has no direction.
Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const float largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0)) return otherwise;
  return unit(v * (1.0f / largest));  // tiny triangles have normals whose square underflows
}

// The matrix that carries normals: the cofactors of m's linear part, which unlike the inverse transpose exist
// for every matrix; their sign is set so that the front stays the front.
Matrix normal_matrix(const Matrix& m) {
  const Vec3 r0{m[0][0], m[0][1], m[0][2]}, r1{m[1][0], m[1][1], m[1][2]}, r2{m[2][0], m[2][1], m[2][2]};
  const Vec3 c0 = cross(r1, r2), c1 = cross(r2, r0), c2 = cross(r0, r1);
  const float sign = dot(r0, c0) < 0 ? -1.0f : 1.0f;
  Matrix n;
  for (int i = 0; i < 3; ++i) {
    n[0][i] = sign * c0[i];
    n[1][i] = sign * c1[i];
    n[2][i] = sign * c2[i];
  }
  return n;
}

}  // namespace

Geometry::Geometry(const Scene& scene) : sphere_lights(scene.spheres.size(), -1), scene_(&scene) {
  for (const Instance& i : scene.instances)
    pieces.push_back({&scene.meshes[static_cast<std::size_t>(i.mesh)], i.to_world, normal_matrix(i.to_world),
                      i.to_world != Matrix(), -1});
  pieces.push_back({});
}

Triangle Geometry::triangle(std::uint32_t piece, std::uint32_t primitive) const {
  const Piece& from = pieces[piece];
  const auto& corner = from.mesh->triangles[primitive];
  Triangle t;
  for (std::size_t i = 0; i < 3; ++i) t.p[i] = from.mesh->positions[corner[i]];
  t.normal = cross(t.p[1] - t.p[0], t.p[2] - t.p[0]);
  if (from.placed) {
    for (Vec3& p : t.p) p = moved(p, from.to_world);
    t.normal = turned(t.normal, from.normal_to_world);
  }
  return t;
}

Vec3 Geometry::to_world(std::uint32_t piece, const Vec3& point) const {
  return pieces[piece].placed ? moved(point, pieces[piece].to_world) : point;
}

Vec2 Geometry::uv(const Hit& hit) const {
  const Piece& piece = pieces[hit.piece];
  if (!piece.mesh || piece.mesh->uvs.empty()) return {0, 0};
  const auto& corner = piece.mesh->triangles[hit.primitive];
  const auto& uvs = piece.mesh->uvs;
  return blend(uvs[corner[0]], uvs[corner[1]], uvs[corner[2]], hit.u, hit.v);
}

Vec2 Geometry::uv2(const Hit& hit) const {
  const Piece& piece = pieces[hit.piece];
  if (!piece.mesh || piece.mesh->uvs2.empty()) return uv(hit);
  const auto& corner = piece.mesh->triangles[hit.primitive];
  const auto& uvs = piece.mesh->uvs2;
  return blend(uvs[corner[0]], uvs[corner[1]], uvs[corner[2]], hit.u, hit.v);
}

bool Geometry::tangents(const Hit& hit, const Texture& texture, Vec3& along_u, Vec3& up) const {
  const Piece& piece = pieces[hit.piece];
  if (!piece.mesh) return false;
  const auto& corner = piece.mesh->triangles[hit.primitive];
  const auto& uvs = texture.uv_set == 0 || piece.mesh->uvs2.empty() ? piece.mesh->uvs : piece.mesh->uvs2;
  if (uvs.empty()) return false;
  const auto turned_uv = [&](const Vec2& d) {
    const auto& t = texture.transform;
    return Vec2(t[0] * d.x + t[1] * d.y, t[3] * d.x + t[4] * d.y);
  };
  const Vec2 a = turned_uv(uvs[corner[1]] - uvs[corner[0]]), b = turned_uv(uvs[corner[2]] - uvs[corner[0]]);
  const float area = a.x * b.y - a.y * b.x;
  if (!(std::abs(area) > 0)) return false;
  const Triangle t = triangle(hit.piece, hit.primitive);
  const Vec3 e1 = t.p[1] - t.p[0], e2 = t.p[2] - t.p[0];
  const float sign = area < 0 ? -1.0f : 1.0f;
  along_u = (e1 * b.y - e2 * a.y) * sign;
  up = (e1 * b.x - e2 * a.x) * sign;
  return dot(along_u, along_u) > 0 && dot(up, up) > 0;
}

Surface Geometry::sphere_surface(const Hit& hit, const Vec3& point) const {
  const Sphere& sphere = scene_->spheres[hit.primitive];
  Surface s;
  s.ng = s.ns = unit_or(point - sphere.center, {0, 0, 1});
  s.position = sphere.center + s.ng * sphere.radius;
  s.uv = s.uv2 = sphere_uv(s.ng);
  s.material = sphere.material;
  s.light = sphere_lights[hit.primitive];
  return s;
}

Surface Geometry::surface(const Hit& hit, const Vec3& origin, const Vec3& direction, float distance, float) const {
  const Piece& piece = pieces[hit.piece];
  if (!piece.mesh) return sphere_surface(hit, origin + direction * distance);
  const Triangle t = triangle(hit.piece, hit.primitive);
  Surface s;
  // From the corners, not along the ray: exact to the last bits however far the ray came.
  s.position = blend(t.p[0], t.p[1], t.p[2], hit.u, hit.v);
  s.ng = s.ns = unit_or(t.normal, -direction);
  s.material = piece.mesh->material;
  s.light = piece.light;
  if (!piece.mesh->normals.empty()) {
    const auto& corner = piece.mesh->triangles[hit.primitive];
    const auto& normals = piece.mesh->normals;
    const Vec3 n = blend(normals[corner[0]], normals[corner[1]], normals[corner[2]], hit.u, hit.v);
    s.ns = unit_or(piece.placed ? turned(n, piece.normal_to_world) : n, s.ng);
  }
  if (!piece.mesh->uvs.empty()) s.uv = s.uv2 = uv(hit);
  if (!piece.mesh->uvs2.empty()) s.uv2 = uv2(hit);
  return s;
}

Vec2 sphere_uv(const Vec3& n) {
  return {0.5f + std::atan2(n.x, -n.z) * (0.5f * kInvPi), std::acos(std::clamp(n.y, -1.0f, 1.0f)) * kInvPi};
}

Vec3 offset_origin(const Vec3& p, const Vec3& normal) {
  constexpr float kNear = 1.0f / 32, kFloatScale = 1.0f / 65536, kIntScale = 256.0f;
  const auto moved_along = [&](float x, float n) {
    if (std::abs(x) < kNear) return x + kFloatScale * n;
    const int steps = static_cast<int>(kIntScale * n);
    return std::bit_cast<float>(std::bit_cast<int>(x) + (x < 0 ? -steps : steps));
  };
  return {moved_along(p.x, normal.x), moved_along(p.y, normal.y), moved_along(p.z, normal.z)};
}

}  // namespace tessera::tracer
