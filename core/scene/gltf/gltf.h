// SPDX-License-Identifier: Apache-2.0
// Reads glTF 2.0 (.gltf, .glb) as the Khronos specification 2.0.1 defines it; docs/SCENE.md lists the
// extensions understood. Numbers of KHR_lights_punctual are taken as radiometric: candela as W/sr, lux as
// W/m^2.
#pragma once

#include <filesystem>

#include "core/scene/files.h"
#include "core/scene/limits.h"
#include "core/scene/scene.h"

namespace tessera {

// Throws InputError, at `where` if the file is missing, at the file if its contents are wrong.
Scene read_gltf(const std::filesystem::path& file, const ImportLimits& limits, std::string_view where = {});

}  // namespace tessera
