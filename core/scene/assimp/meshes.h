// SPDX-License-Identifier: Apache-2.0
// The meshes of a file that assimp has read. Only for the files of this folder.
#pragma once

#include <vector>

#include "core/scene/files.h"
#include "core/scene/limits.h"
#include "core/scene/scene.h"

struct aiScene;

namespace tessera::assimp {

// Adds the meshes of triangles; the materials are there. The index of ours for each of assimp's, -1: none.
std::vector<int> add_meshes(Scene& scene, const aiScene& from, const ImportLimits& limits,
                            const std::string& file);

}  // namespace tessera::assimp
