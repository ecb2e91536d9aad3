// SPDX-License-Identifier: Apache-2.0
// The materials of a file that assimp has read. Only for the files of this folder.
#pragma once

#include <filesystem>
#include <set>

#include "core/scene/files.h"
#include "core/scene/limits.h"
#include "core/scene/scene.h"

struct aiScene;

namespace tessera::assimp {

// Adds all materials in their order. `physical` names those that are metallic-roughness whatever else they
// say.
void add_materials(Scene& scene, const aiScene& from, const std::filesystem::path& file,
                   const std::set<std::string>& physical, const ImportLimits& limits);

}  // namespace tessera::assimp
