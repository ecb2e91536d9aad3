// SPDX-License-Identifier: Apache-2.0
#include "core/scene/framing.h"

#include <algorithm>
#include <cmath>

namespace tessera {

// Where what moves begins.
Matrix first_pose(const Scene& scene, const Instance& instance) {
  const int track = instance.object < 0 ? -1 : scene.objects[static_cast<std::size_t>(instance.object)].track;
  return track < 0 ? Matrix() : scene.tracks[static_cast<std::size_t>(track)].poses.front();
}

Imath::Box3f bounds_of(const Scene& scene) {
  std::vector<Imath::Box3f> boxes(scene.meshes.size());
  for (std::size_t m = 0; m < boxes.size(); ++m)
    for (const auto& triangle : scene.meshes[m].triangles)
      for (const std::uint32_t v : triangle) boxes[m].extendBy(scene.meshes[m].positions[v]);
  Imath::Box3f bounds;
  for (const Instance& instance : scene.instances) {
    const Imath::Box3f& box = boxes[static_cast<std::size_t>(instance.mesh)];
    const Matrix stands = instance.to_world * first_pose(scene, instance);
    for (int corner = 0; !box.isEmpty() && corner < 8; ++corner)
      bounds.extendBy(Vec3(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                           corner & 4 ? box.max.z : box.min.z) *
                      stands);
  }
  for (const Sphere& s : scene.spheres) {
    bounds.extendBy(s.center - Vec3(s.radius));
    bounds.extendBy(s.center + Vec3(s.radius));
  }
  for (const Quad& q : scene.quads)
    for (const Vec3& corner :
         {q.corner, q.corner + q.edge_u, q.corner + q.edge_v, q.corner + q.edge_u + q.edge_v})
      bounds.extendBy(corner);
  for (const Disk& d : scene.disks) {
    const auto reach = [&](float n) { return d.radius * std::sqrt(std::max(0.0f, 1 - n * n)); };
    const Vec3 extent(reach(d.normal.x), reach(d.normal.y), reach(d.normal.z));
    bounds.extendBy(d.center - extent);
    bounds.extendBy(d.center + extent);
  }
  return bounds;
}

Camera framing_camera(const Scene& scene) {
  Imath::Box3f bounds = bounds_of(scene);
  if (bounds.isEmpty()) bounds = {Vec3(-1), Vec3(1)};
  const Vec3 back = Vec3(0.4f, 0.35f, 1.0f).normalized();
  const Vec3 x = Vec3(0, 1, 0).cross(back).normalized(), y = back.cross(x);
  Camera camera;
  const float distance = 0.5f * bounds.size().length() / std::sin(0.5f * camera.vertical_fov);
  const Vec3 eye = bounds.center() + back * distance;
  camera.to_world = {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, back.x, back.y, back.z, 0, eye.x, eye.y, eye.z, 1};
  camera.focus_distance = distance;
  return camera;
}

}  // namespace tessera
