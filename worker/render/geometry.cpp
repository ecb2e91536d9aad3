// SPDX-License-Identifier: Apache-2.0
#include "worker/render/geometry.h"

#include <bit>

#include "worker/render/motion.h"

namespace tessera::tracer {
namespace {

Vec3 turned(const Vec3& v, const Matrix& m) {
  return {v.x * m[0][0] + v.y * m[1][0] + v.z * m[2][0], v.x * m[0][1] + v.y * m[1][1] + v.z * m[2][1],
          v.x * m[0][2] + v.y * m[1][2] + v.z * m[2][2]};
}

// Of so many triangles corners are kept side by side, at 36 bytes each: shading then waits for one or two
// lines of memory at a hit in place of four that it must look for.
constexpr std::size_t kMostCorners = std::size_t{1} << 21;

template <typename T>
T blend(const T& a, const T& b, const T& c, float u, float v) {
  return a * (1.0f - u - v) + b * u + c * v;
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

Triangle own_triangle(const Mesh& mesh, std::uint32_t primitive) {
  const auto& corner = mesh.triangles[primitive];
  Triangle t;
  for (std::size_t i = 0; i < 3; ++i) t.p[i] = mesh.positions[corner[i]];
  t.normal = cross(t.p[1] - t.p[0], t.p[2] - t.p[0]);
  return t;
}

// (0, 0) if there are none.
Vec2 uv_in(const Mesh& mesh, const std::vector<Vec2>& uvs, const Hit& hit) {
  if (uvs.empty()) return {0, 0};
  const auto& corner = mesh.triangles[hit.primitive];
  return blend(uvs[corner[0]], uvs[corner[1]], uvs[corner[2]], hit.u, hit.v);
}

// Precondition: there are some. Of any length.
Vec3 normal_in(const Mesh& mesh, const Hit& hit) {
  const auto& corner = mesh.triangles[hit.primitive];
  return blend(mesh.normals[corner[0]], mesh.normals[corner[1]], mesh.normals[corner[2]], hit.u, hit.v);
}

// Edges of a surface as differences of texture coordinates, to the directions of the coordinates.
bool solve_tangents(const Vec3& e1, const Vec3& e2, const Vec2& a, const Vec2& b, Vec3& along_u, Vec3& up) {
  const float area = a.x * b.y - a.y * b.x;
  if (!(std::abs(area) > 0)) return false;
  const float sign = area < 0 ? -1.0f : 1.0f;
  along_u = (e1 * b.y - e2 * a.y) * sign;
  up = (e1 * b.x - e2 * a.x) * sign;
  return dot(along_u, along_u) > 0 && dot(up, up) > 0;
}

void place(Triangle& t, const Matrix& m, const Matrix& normals) {
  for (Vec3& p : t.p) p = moved(p, m);
  t.normal = turned(t.normal, normals);
}

}  // namespace

Geometry::Geometry(const Scene& scene, Shutter shutter)
    : sphere_lights(scene.spheres.size(), -1),
      quad_lights(scene.quads.size(), -1),
      disk_lights(scene.disks.size(), -1),
      scene_(&scene) {
  for (const Track& t : scene.tracks) {
    Movement movement(t);
    std::vector<Matrix> steps = motion_steps(movement, shutter);
    motions_.push_back({std::move(movement), std::move(steps)});
  }
  pieces.reserve(scene.instances.size());
  for (const Instance& i : scene.instances) {
    Piece piece{.seen_by = seen_by(scene, i.object)};
    if (i.object >= 0) piece.track = scene.objects[static_cast<std::size_t>(i.object)].track;
    piece.placed = piece.track >= 0 || i.to_world != Matrix();
    pieces.push_back(piece);
  }
  keep_corners();
  add_shapes();
}

void Geometry::keep_corners() {
  corners_.resize(scene_->meshes.size());
  std::size_t room = kMostCorners;
  for (std::uint32_t i = 0; i < meshes(); ++i) {
    const Mesh& of = mesh(i);
    std::vector<Corners>& kept = corners_[static_cast<std::size_t>(scene_->instances[i].mesh)];
    if (pieces[i].placed || of.triangles.empty()) continue;
    if (kept.empty()) {
      if (of.triangles.size() > room) continue;
      room -= of.triangles.size();
      kept.reserve(of.triangles.size());
      for (const auto& t : of.triangles)
        kept.push_back({of.positions[t[0]], of.positions[t[1]], of.positions[t[2]]});
    }
    pieces[i].corners = kept.data();
  }
}

Triangle Geometry::triangle(std::uint32_t piece, std::uint32_t primitive, float time) const {
  Triangle t = own_triangle(mesh(piece), primitive);
  if (pieces[piece].placed) {
    const Matrix m = to_world(piece, time);
    place(t, m, normal_matrix(m));
  }
  return t;
}

Matrix Geometry::to_world(std::uint32_t piece, float time) const {
  const Matrix& rest = scene_->instances[piece].to_world;
  if (pieces[piece].track < 0) return rest;
  const std::vector<Matrix>& steps = motions_[static_cast<std::size_t>(pieces[piece].track)].steps;
  if (steps.size() == 1) return rest * steps[0];
  const float at = std::clamp(time, 0.0f, 1.0f) * static_cast<float>(steps.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), steps.size() - 2);
  const float share = at - static_cast<float>(i);
  return rest * (steps[i] * (1.0f - share) + steps[i + 1] * share);
}

Matrix Geometry::to_world_at(std::uint32_t piece, double seconds) const {
  const Matrix& rest = scene_->instances[piece].to_world;
  const int track = pieces[piece].track;
  return track < 0 ? rest : rest * motions_[static_cast<std::size_t>(track)].movement.at(seconds);
}

std::size_t Geometry::steps(std::uint32_t piece) const {
  const int track = pieces[piece].track;
  return track < 0 ? 1 : motions_[static_cast<std::size_t>(track)].steps.size();
}

Matrix Geometry::step(std::uint32_t piece, std::size_t i) const {
  const Matrix& rest = scene_->instances[piece].to_world;
  const int track = pieces[piece].track;
  return track < 0 ? rest : rest * motions_[static_cast<std::size_t>(track)].steps[i];
}

Vec2 Geometry::uv(const Hit& hit) const {
  const Mesh* of = mesh_at(hit);
  return of ? uv_in(*of, of->uvs, hit) : Vec2(hit.u, hit.v);
}

Vec2 Geometry::uv2(const Hit& hit) const {
  const Mesh* of = mesh_at(hit);
  return of && !of->uvs2.empty() ? uv_in(*of, of->uvs2, hit) : uv(hit);
}

bool Geometry::tangents(const Hit& hit, const Texture& texture, Vec3& along_u, Vec3& up, float time) const {
  const auto turned_uv = [&](const Vec2& d) {
    const auto& t = texture.transform;
    return Vec2(t[0] * d.x + t[1] * d.y, t[3] * d.x + t[4] * d.y);
  };
  if (pieces[hit.piece].kind == Piece::Kind::quads) {
    const Quad& q = scene_->quads[shape(hit)];
    return solve_tangents(q.edge_u, q.edge_v, turned_uv({1, 0}), turned_uv({0, 1}), along_u, up);
  }
  const Mesh* of = mesh_at(hit);
  if (!of) return false;
  const auto& uvs = texture.uv_set == 0 || of->uvs2.empty() ? of->uvs : of->uvs2;
  if (uvs.empty()) return false;
  const auto& corner = of->triangles[hit.primitive];
  const Triangle t = triangle(hit.piece, hit.primitive, time);
  return solve_tangents(t.p[1] - t.p[0], t.p[2] - t.p[0], turned_uv(uvs[corner[1]] - uvs[corner[0]]),
                        turned_uv(uvs[corner[2]] - uvs[corner[0]]), along_u, up);
}

Surface Geometry::surface(const Hit& hit, const Vec3& origin, const Vec3& direction, float distance,
                          float time) const {
  const Piece& piece = pieces[hit.piece];
  if (piece.kind == Piece::Kind::spheres) return sphere_surface(hit, origin + direction * distance);
  if (piece.kind == Piece::Kind::quads) return quad_surface(hit);
  if (piece.kind == Piece::Kind::disks) return disk_surface(hit, origin + direction * distance);
  const Mesh& of = mesh(hit.piece);
  Triangle t = own_triangle(of, hit.primitive);
  Matrix normals;
  if (piece.placed) {
    const Matrix m = to_world(hit.piece, time);
    normals = normal_matrix(m);
    place(t, m, normals);
  }
  Surface s;
  // From the corners, not along the ray: exact to the last bits however far the ray came.
  s.position = blend(t.p[0], t.p[1], t.p[2], hit.u, hit.v);
  s.ng = s.ns = unit_or(t.normal, -direction);
  s.material = of.material;
  s.time = time;
  if (piece.light >= 0) {
    s.light = piece.light + piece.light_step * static_cast<int>(hit.primitive);
    s.area = 0.5f * length(t.normal);
    s.primitive = hit.primitive;
  }
  if (!of.normals.empty()) {
    const Vec3 n = normal_in(of, hit);
    s.ns = unit_or(piece.placed ? turned(n, normals) : n, s.ng);
  }
  if (!of.uvs.empty()) s.uv = s.uv2 = uv(hit);
  if (!of.uvs2.empty()) s.uv2 = uv2(hit);
  return s;
}

void Geometry::surface_at(const Hit& hit, const Vec3& position, const Vec3& ng, float time,
                          Surface& s) const {
  const Mesh& of = mesh(hit.piece);
  s.position = position;
  s.ng = s.ns = ng;
  s.material = of.material;
  s.light = -1;
  s.time = time;
  if (!of.normals.empty()) s.ns = unit_or(normal_in(of, hit), ng);
  s.uv = s.uv2 = uv_in(of, of.uvs, hit);
  if (!of.uvs2.empty()) s.uv2 = uv_in(of, of.uvs2, hit);
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
