// SPDX-License-Identifier: Apache-2.0
// A scene made to catch differences: overlapping coplanar grids, on which rays tie, a textureless sphere of
// metal and one of glass, a sun, a lamp and a sky.
#pragma once

#include <memory>

#include "core/job.h"
#include "core/scene/load.h"
#include "core/scene/scene.h"

namespace tessera::farm {

// A grid of `n` x `n` squares in the plane y = 0, shifted so that its triangles cross those of the others.
inline Mesh grid(int n, float shift, int material) {
  Mesh mesh;
  mesh.name = "grid";
  mesh.material = material;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      mesh.positions.push_back({8.0f * static_cast<float>(x) / static_cast<float>(n) - 4.0f + shift, 0.0f,
                                8.0f * static_cast<float>(y) / static_cast<float>(n) - 6.0f + shift});
  const auto at = [n](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      mesh.triangles.push_back({at(x, y), at(x, y + 1), at(x + 1, y)});
      mesh.triangles.push_back({at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)});
    }
  return mesh;
}

inline std::shared_ptr<const Scene> small_scene() {
  Scene scene;
  scene.materials = {{.name = "red", .base_color = {0.8f, 0.2f, 0.2f}},
                     {.name = "grey", .base_color = {0.6f, 0.6f, 0.6f}},
                     {.name = "metal", .kind = Material::Kind::metal, .roughness = 0.4f},
                     {.name = "glass", .kind = Material::Kind::glass},
                     {.name = "lamp", .base_color = {0, 0, 0}, .emission = {9, 8, 7}}};
  scene.meshes = {grid(7, 0.0f, 0), grid(10, 0.013f, 1)};
  scene.instances = {{0, Matrix()}, {1, Matrix()}};
  scene.spheres = {
      {{-1.0f, 0.7f, -2.0f}, 0.7f, 2}, {{1.0f, 0.6f, -1.6f}, 0.6f, 3}, {{0.2f, 3.0f, -2.5f}, 0.4f, 4}};
  scene.suns = {{.direction = {0.4f, -0.8f, -0.447214f}, .irradiance = {2, 2, 2}, .angular_diameter = 0.05f}};
  scene.environment.radiance = {0.3f, 0.4f, 0.5f};
  Camera camera;
  camera.to_world.setTranslation(Vec3(0.0f, 1.2f, 3.0f));
  camera.vertical_fov = 0.8f;
  scene.cameras = {camera};
  return std::make_shared<const Scene>(std::move(scene));
}

inline Job small_job(const Scene& scene) {
  Job job;
  job.scene.hash = content_hash(scene);
  job.render.size = {77, 70};  // odd, and more than one cell
  job.render.max_bounces = 3;
  job.filter = parse_filter("svgf:levels=2");
  job.acceptance.relmse = 0.02;
  job.acceptance.max_samples = 32;
  job.tile = {40, 33};
  job.task_samples = 1 << 14;
  return job;
}

}  // namespace tessera::farm
