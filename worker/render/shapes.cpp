// SPDX-License-Identifier: Apache-2.0
// The part of Geometry that is about whose a hit is, and about spheres, quads and disks.
#include "worker/render/geometry.h"

namespace tessera::tracer {
namespace {

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

}  // namespace

std::uint8_t seen_by(const Scene& scene, int object) {
  if (object < 0) return kSeenByAll;
  const Object& o = scene.objects[static_cast<std::size_t>(object)];
  return static_cast<std::uint8_t>((o.camera ? bit(RayKind::camera) : 0) |
                                   (o.scattered ? bit(RayKind::scattered) : 0) |
                                   (o.shadow ? bit(RayKind::shadow) : 0));
}

void Geometry::add_shapes() {
  const auto add = [&](Piece::Kind kind, const auto& shapes) {
    std::array<std::vector<std::uint32_t>, kSeenByAll + 1> groups;
    for (std::size_t i = 0; i < shapes.size(); ++i)
      groups[seen_by(*scene_, shapes[i].object)].push_back(static_cast<std::uint32_t>(i));
    for (std::size_t bits = 0; bits < groups.size(); ++bits) {  // what nobody sees may still be a light
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
  const Mesh* of = mesh_at(hit);
  return of ? of->material : material_of(*scene_, pieces[hit.piece].kind, shape(hit));
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

Vec2 Geometry::shape_uv(const Hit& hit, const Vec3& point) const {
  if (pieces[hit.piece].kind == Piece::Kind::disks) return disk_uv(scene_->disks[shape(hit)], point);
  return sphere_uv(unit_or(point - scene_->spheres[shape(hit)].center, {0, 0, 1}));
}

Surface Geometry::sphere_surface(const Hit& hit, const Vec3& point) const {
  const Sphere& sphere = scene_->spheres[shape(hit)];
  Surface s;
  s.ng = s.ns = unit_or(point - sphere.center, {0, 0, 1});
  s.position = sphere.center + s.ng * sphere.radius;
  s.uv = s.uv2 = sphere_uv(s.ng);
  s.material = sphere.material;
  s.light = sphere_lights[shape(hit)];
  return s;
}

Surface Geometry::quad_surface(const Hit& hit) const {
  const Quad& quad = scene_->quads[shape(hit)];
  Surface s;
  s.position = quad.corner + quad.edge_u * hit.u + quad.edge_v * hit.v;
  s.ng = s.ns = unit_or(cross(quad.edge_u, quad.edge_v), {0, 0, 1});
  s.uv = s.uv2 = {hit.u, hit.v};
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
  s.uv = s.uv2 = disk_uv(disk, point);
  s.material = disk.material;
  s.light = disk_lights[shape(hit)];
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

}  // namespace tessera::tracer
