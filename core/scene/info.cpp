// SPDX-License-Identifier: Apache-2.0
#include "core/scene/info.h"

#include <algorithm>

#include "core/scene/framing.h"
#include "core/scene/native/material_fields.h"

namespace tessera {
namespace {

template <class T>
std::uint64_t bytes_in(const std::vector<T>& list) {
  return list.size() * sizeof(T);
}

std::uint64_t bytes_of(const Mesh& m) {
  return bytes_in(m.positions) + bytes_in(m.normals) + bytes_in(m.uvs) + bytes_in(m.uvs2) +
         bytes_in(m.colors) + bytes_in(m.triangles);
}

std::uint64_t bytes_of(const Picture& p) { return bytes_in(p.pixels); }

template <class Things>
std::uint64_t bytes_of_all(const Things& things) {
  std::uint64_t bytes = 0;
  for (const auto& thing : things) bytes += bytes_of(thing);
  return bytes;
}

template <class Things>
std::vector<std::string> names_of(const Things& things) {
  std::vector<std::string> names;
  for (const auto& thing : things) names.push_back(thing.name);
  return names;
}

Counts materials_by_kind(const Scene& scene) {
  Counts counts;
  for (const auto& [name, kind] : kKinds) {
    const auto n = std::count_if(scene.materials.begin(), scene.materials.end(),
                                 [kind = kind](const Material& m) { return m.kind == kind; });
    if (n > 0) counts.emplace_back(name, n);
  }
  return counts;
}

Counts lights_by_kind(const Scene& scene) {
  const auto emits = [&](int material) {
    return scene.materials[static_cast<std::size_t>(material)].emission != Color(0);
  };
  const auto emitting = [&](const auto& shapes) {
    return static_cast<std::uint64_t>(std::count_if(
        shapes.begin(), shapes.end(), [&](const auto& shape) { return emits(shape.material); }));
  };
  std::uint64_t triangles = 0;
  for (const Instance& i : scene.instances) {
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(i.mesh)];
    if (emits(mesh.material)) triangles += mesh.triangles.size();
  }
  const bool surrounded = scene.environment.radiance != Color(0);
  return {{"point", scene.points.size()},
          {"spot", scene.spots.size()},
          {"directional", scene.suns.size()},
          {"environment", surrounded ? 1 : 0},
          {"emissive triangles", triangles},
          {"emissive spheres", emitting(scene.spheres)},
          {"emissive quads", emitting(scene.quads)},
          {"emissive disks", emitting(scene.disks)}};
}

}  // namespace

SceneInfo info_of(const Scene& scene) {
  SceneInfo info;
  for (const Mesh& m : scene.meshes)
    info.triangles += m.triangles.size(), info.vertices += m.positions.size();
  for (const Instance& i : scene.instances)
    info.instanced_triangles += scene.meshes[static_cast<std::size_t>(i.mesh)].triangles.size();
  info.things = {{"meshes", scene.meshes.size()},   {"instances", scene.instances.size()},
                 {"spheres", scene.spheres.size()}, {"quads", scene.quads.size()},
                 {"disks", scene.disks.size()},     {"objects", scene.objects.size()},
                 {"tracks", scene.tracks.size()}};
  info.materials = materials_by_kind(scene);
  info.lights = lights_by_kind(scene);
  info.memory = {{"meshes", bytes_of_all(scene.meshes)},
                 {"instances", bytes_in(scene.instances)},
                 {"pictures", bytes_of_all(scene.pictures)}};
  for (const Picture& p : scene.pictures)
    info.pictures.push_back({p.name, p.width, p.height, p.channels, bytes_of(p)});
  info.cameras = names_of(scene.cameras);
  info.variants = names_of(scene.variants);
  info.light_groups = scene.light_groups;
  info.bounds = bounds_of(scene);
  info.warnings = scene.warnings;
  return info;
}

}  // namespace tessera
