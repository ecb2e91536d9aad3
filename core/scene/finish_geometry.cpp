// SPDX-License-Identifier: Apache-2.0
// Meshes, what stands where, and shapes.
#include <fmt/format.h>

#include <cmath>

#include "core/scene/finish_parts.h"
#include "core/scene/tidy.h"

namespace tessera::finishing {
namespace {

void check_mesh(const Context& c, const Mesh& mesh, const std::string& owner) {
  const std::size_t vertices = mesh.positions.size();
  if (mesh.triangles.size() > kMaxIndices / 3)
    c.refuse(fmt::format("{} has {} triangles", owner, mesh.triangles.size()),
             fmt::format("at most {}", kMaxIndices / 3));
  for (const std::size_t size : {mesh.normals.size(), mesh.uvs.size(), mesh.uvs2.size(), mesh.colors.size()})
    if (size != 0 && size != vertices)
      c.refuse(fmt::format("{} has a list of {} for {} vertices", owner, size, vertices),
               "one a vertex, or none");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (v >= vertices) c.refuse(fmt::format("{} uses vertex {} of {}", owner, v, vertices));
  c.require_index(mesh.material, c.scene.materials.size(), false, owner, "material");
}

void finish_mesh(const Context& c, Mesh& mesh) {
  const std::string owner = fmt::format("mesh '{}'", mesh.name);
  check_mesh(c, mesh, owner);
  const Tidied tidied = tidy(mesh);
  if (tidied.not_finite > 0)
    c.warn(fmt::format("{}: {} triangles with coordinates that are not finite or beyond {:g} are left out",
                       owner, tidied.not_finite, kMaxCoordinate));
  if (tidied.degenerate > 0)
    c.warn(fmt::format("{}: {} triangles without an area are left out", owner, tidied.degenerate));
  if (tidied.colors > 0)
    c.warn(fmt::format("{}: {} vertex colours beyond 0..1 are pulled into it", owner, tidied.colors));
}

void check_track(const Context& c, const Track& track, std::size_t index) {
  const std::string owner = fmt::format("track {}", index);
  if (track.times.empty() || track.times.size() != track.poses.size())
    c.refuse(fmt::format("{} has {} times and {} poses", owner, track.times.size(), track.poses.size()),
             "as many of both, at least one");
  for (std::size_t t = 0; t < track.times.size(); ++t) {
    if (!std::isfinite(track.times[t]) || (t > 0 && !(track.times[t] > track.times[t - 1])))
      c.refuse(fmt::format("{}: time {} is {}", owner, t, track.times[t]), "rising times");
    if (!finite(track.poses[t]) || !(std::abs(track.poses[t].determinant()) > 0))
      c.refuse(fmt::format("{}: pose {} is not finite or flat", owner, t), "matrices with an inverse");
  }
}

void finish_instances(const Context& c) {
  std::erase_if(c.scene.instances, [&](const Instance& i) {
    c.require_index(i.mesh, c.scene.meshes.size(), false, "an instance", "mesh");
    const Mesh& mesh = c.scene.meshes[static_cast<std::size_t>(i.mesh)];
    const std::string owner = fmt::format("an instance of mesh '{}'", mesh.name);
    c.require_index(i.object, c.scene.objects.size(), true, owner, "object");
    const bool flat = !finite(i.to_world) || !(std::abs(i.to_world.determinant()) > 0);
    return mesh.triangles.empty() || c.unusable(owner, !flat);
  });
}

// `has_size(shape)` is asked of shapes whose indices are right.
template <class Shape, class HasSize>
void finish_shapes(const Context& c, std::vector<Shape>& shapes, const char* name, const HasSize& has_size) {
  std::erase_if(shapes, [&](const Shape& shape) {
    c.require_index(shape.material, c.scene.materials.size(), false, name, "material");
    c.require_index(shape.object, c.scene.objects.size(), true, name, "object");
    return c.unusable(name, has_size(shape));
  });
}

bool is_near(const Vec3& p) {
  return std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate &&
         std::abs(p.z) <= kMaxCoordinate;
}

bool is_size(float radius) { return radius > 0 && radius <= kMaxCoordinate; }

}  // namespace

void finish_geometry(const Context& c) {
  Scene& scene = c.scene;
  for (Mesh& mesh : scene.meshes) finish_mesh(c, mesh);
  for (std::size_t t = 0; t < scene.tracks.size(); ++t) check_track(c, scene.tracks[t], t);
  for (Object& object : scene.objects) {
    const std::string owner = fmt::format("object '{}'", object.name);
    c.require_index(object.track, scene.tracks.size(), true, owner, "track");
    c.require_light(object.light, owner);
  }
  finish_instances(c);
  finish_shapes(c, scene.spheres, "a sphere",
                [](const Sphere& s) { return is_near(s.center) && is_size(s.radius); });
  finish_shapes(c, scene.disks, "a disk", [](const Disk& d) {
    return is_near(d.center) && is_size(d.radius) && is_direction(d.normal);
  });
  finish_shapes(c, scene.quads, "a quad", [](const Quad& q) {
    const Imath::V3d cross = Imath::V3d(q.edge_u).cross(Imath::V3d(q.edge_v));
    return is_near(q.corner) && is_near(q.edge_u) && is_near(q.edge_v) && cross.dot(cross) > 0;
  });
  for (const Variant& variant : scene.variants)
    for (const Variant::Choice& choice : variant.choices) {
      const std::string owner = fmt::format("variant '{}'", variant.name);
      c.require_index(choice.mesh, scene.meshes.size(), false, owner, "mesh");
      c.require_index(choice.material, scene.materials.size(), false, owner, "material");
    }
}

}  // namespace tessera::finishing
