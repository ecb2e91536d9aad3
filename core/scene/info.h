// SPDX-License-Identifier: Apache-2.0
// What is in a scene, in numbers.
#pragma once

#include <Imath/ImathBox.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/scene.h"

namespace tessera {

using Counts = std::vector<std::pair<std::string, std::uint64_t>>;  // by name, in a fixed order

struct SceneInfo {
  struct PictureInfo {
    std::string name;
    int width = 0, height = 0, channels = 0;
    std::uint64_t bytes = 0;
  };
  std::uint64_t triangles = 0;            // each mesh once
  std::uint64_t instanced_triangles = 0;  // as often as the meshes stand
  std::uint64_t vertices = 0;
  Counts things;     // meshes, instances, spheres, quads, disks, objects, tracks
  Counts materials;  // by kind
  Counts lights;     // by kind; emissive things by their materials
  Counts memory;     // bytes: meshes, instances, pictures; of the scene alone, not of what renders it
  std::vector<PictureInfo> pictures;
  std::vector<std::string> cameras, variants, light_groups;
  Imath::Box3f bounds;  // world space, of what rests or before it moves; empty if there is nothing
  std::vector<std::string> warnings;
};

SceneInfo info_of(const Scene&);

}  // namespace tessera
