// SPDX-License-Identifier: Apache-2.0
// Reads Wavefront OBJ and its MTL material files, through assimp.
#pragma once

#include <filesystem>

#include "core/scene/files.h"
#include "core/scene/scene.h"

namespace tessera {

// Materials are diffuse: Kd, map_Kd, Ke. Coordinates are taken as they are (+Y up).
// Throws InputError, at `where` if the file is missing, at the file if its contents are wrong.
Scene read_obj(const std::filesystem::path& file, const ImportLimits& limits, std::string_view where = {});

}  // namespace tessera
