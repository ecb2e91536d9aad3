// SPDX-License-Identifier: Apache-2.0
// What stands where in a file that assimp has read. Only for the files of this folder.
#pragma once

#include <vector>

#include "core/scene/files.h"
#include "core/scene/scene.h"

struct aiScene;

namespace tessera::assimp {

// Adds an object for each node with meshes, instances, cameras and lights. `meshes` is what add_meshes
// returned; `root` turns the file's world into ours.
void add_nodes(Scene& scene, const aiScene& from, const std::vector<int>& meshes, const Matrix& root,
               const ImportLimits& limits, const std::string& file);

}  // namespace tessera::assimp
