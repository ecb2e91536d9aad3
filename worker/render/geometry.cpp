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

int material_of(const Scene& scene, Piece::Kind kind, std::uint32_t shape) {
  switch (kind) {
    case Piece::Kind::spheres:
      return scene.spheres[shape].material;
    case Piece::Kind::quads:
      return scene.quads[shape].material;
    default:
      return scene.disks[shape].material;
  }
}

Triangle own_triangle(const Mesh& mesh, std::uint32_t primitive) {
  const auto& corner = mesh.triangles[primitive];
  Triangle t;
  for (std::size_t i = 0; i < 3; ++i) t.p[i] = mesh.positions[corner[i]];
  t.normal = cross(t.p[1] - t.p[0], t.p[2] - t.p[0]);
  return t;
}

void place(Triangle& t, const Matrix& m, const Matrix& normals) {
  for (Vec3& p : t.p) p = moved(p, m);
  t.normal = turned(t.normal, normals);
}

std::uint8_t seen_by(const Scene& scene, int object) {
  if (object < 0) return kSeenByAll;
  const Object& o = scene.objects[static_cast<std::size_t>(object)];
  return static_cast<std::uint8_t>((o.camera ? bit(RayKind::camera) : 0) |
                                   (o.scattered ? bit(RayKind::scattered) : 0) |
                                   (o.shadow ? bit(RayKind::shadow) : 0));
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
  add_shapes();
}

void Geometry::add_shapes() {
  const auto add = [&](Piece::Kind kind, const auto& shapes) {
    std::array<std::vector<std::uint32_t>, kSeenByAll + 1> groups;
    for (std::size_t i = 0; i < shapes.size(); ++i)
      groups[seen_by(*scene_, shapes[i].object)].push_back(static_cast<std::uint32_t>(i));
    for (std::size_t bits = 1; bits < groups.size(); ++bits) {  // what nobody sees is not there
      if (groups[bits].empty()) continue;
      pieces.push_back({.kind = kind,
                        .seen_by = static_cast<std::uint8_t>(bits),
                        .shapes = static_cast<std::uint32_t>(members.size())});
      members.push_back(std::move(groups[bits]));
    }
  };
  add(Piece::Kind::spheres, scene_->spheres);
  add(Piece::Kind::quads, scene_->quads);
  add(Piece::Kind::disks, scene_->disks);
}

int Geometry::material(const Hit& hit) const {
  const Piece& piece = pieces[hit.piece];
  return piece.kind == Piece::Kind::mesh ? mesh(hit.piece).material
                                         : material_of(*scene_, piece.kind, shape(hit));
}

int Geometry::object(const Hit& hit) const {
  switch (pieces[hit.piece].kind) {
    case Piece::Kind::mesh:
      return scene_->instances[hit.piece].object;
    case Piece::Kind::spheres:
      return scene_->spheres[shape(hit)].object;
    case Piece::Kind::quads:
      return scene_->quads[shape(hit)].object;
    case Piece::Kind::disks:
      return scene_->disks[shape(hit)].object;
  }
  return -1;
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
  if (pieces[hit.piece].kind != Piece::Kind::mesh) return {hit.u, hit.v};
  const Mesh& of = mesh(hit.piece);
  if (of.uvs.empty()) return {0, 0};
  const auto& corner = of.triangles[hit.primitive];
  return blend(of.uvs[corner[0]], of.uvs[corner[1]], of.uvs[corner[2]], hit.u, hit.v);
}

Vec2 Geometry::shape_uv(const Hit& hit, const Vec3& point) const {
  if (pieces[hit.piece].kind == Piece::Kind::disks) return disk_uv(scene_->disks[shape(hit)], point);
  return sphere_uv(unit_or(point - scene_->spheres[shape(hit)].center, {0, 0, 1}));
}

bool Geometry::tangents(const Hit& hit, Vec3& along_u, Vec3& up, float time) const {
  if (pieces[hit.piece].kind == Piece::Kind::quads) {
    along_u = scene_->quads[shape(hit)].edge_u;
    up = -scene_->quads[shape(hit)].edge_v;
    return true;
  }
  if (pieces[hit.piece].kind != Piece::Kind::mesh || mesh(hit.piece).uvs.empty()) return false;
  const auto& corner = mesh(hit.piece).triangles[hit.primitive];
  const auto& uvs = mesh(hit.piece).uvs;
  const Vec2 a = uvs[corner[1]] - uvs[corner[0]], b = uvs[corner[2]] - uvs[corner[0]];
  const float area = a.x * b.y - a.y * b.x;
  if (!(std::abs(area) > 0)) return false;
  const Triangle t = triangle(hit.piece, hit.primitive, time);
  const Vec3 e1 = t.p[1] - t.p[0], e2 = t.p[2] - t.p[0];
  const float sign = area < 0 ? -1.0f : 1.0f;
  along_u = (e1 * b.y - e2 * a.y) * sign;
  up = (e1 * b.x - e2 * a.x) * sign;
  return dot(along_u, along_u) > 0 && dot(up, up) > 0;
}

Surface Geometry::sphere_surface(const Hit& hit, const Vec3& point) const {
  const Sphere& sphere = scene_->spheres[shape(hit)];
  Surface s;
  s.ng = s.ns = unit_or(point - sphere.center, {0, 0, 1});
  s.position = sphere.center + s.ng * sphere.radius;
  s.uv = sphere_uv(s.ng);
  s.material = sphere.material;
  s.light = sphere_lights[shape(hit)];
  return s;
}

Surface Geometry::quad_surface(const Hit& hit) const {
  const Quad& quad = scene_->quads[shape(hit)];
  Surface s;
  s.position = quad.corner + quad.edge_u * hit.u + quad.edge_v * hit.v;
  s.ng = s.ns = unit_or(cross(quad.edge_u, quad.edge_v), {0, 0, 1});
  s.uv = {hit.u, hit.v};
  s.material = quad.material;
  s.light = quad_lights[shape(hit)];
  return s;
}

Surface Geometry::disk_surface(const Hit& hit, const Vec3& point) const {
  const Disk& disk = scene_->disks[shape(hit)];
  Surface s;
  s.ng = s.ns = unit_or(disk.normal, {0, 0, 1});
  const Vec3 way = point - disk.center;
  s.position = disk.center + (way - s.ng * dot(way, s.ng));
  s.uv = disk_uv(disk, point);
  s.material = disk.material;
  s.light = disk_lights[shape(hit)];
  return s;
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
    const auto& corner = of.triangles[hit.primitive];
    const Vec3 n = blend(of.normals[corner[0]], of.normals[corner[1]], of.normals[corner[2]], hit.u, hit.v);
    s.ns = unit_or(piece.placed ? turned(n, normals) : n, s.ng);
  }
  if (!of.uvs.empty()) s.uv = uv(hit);
  return s;
}

Vec2 disk_uv(const Disk& disk, const Vec3& point) {
  const Frame frame(unit_or(disk.normal, {0, 0, 1}));
  const Vec3 way = (point - disk.center) * (0.5f / disk.radius);
  return {0.5f + dot(way, frame.x), 0.5f + dot(way, frame.y)};
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
