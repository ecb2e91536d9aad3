// SPDX-License-Identifier: Apache-2.0
// Reads Wavefront OBJ with its MTL material files, and Autodesk FBX, through assimp.
#pragma once

#include <filesystem>

#include "core/scene/files.h"
#include "core/scene/scene.h"

namespace tessera {

// Coordinates are taken as they are (+Y up), those of FBX turned and scaled to metres as the file says.
// Throws InputError, at `where` if the file is missing, at the file if its contents are wrong.
Scene read_with_assimp(const std::filesystem::path& file, const ImportLimits& limits,
                       std::string_view where = {});

}  // namespace tessera
