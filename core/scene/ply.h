// SPDX-License-Identifier: Apache-2.0
// Reads Stanford PLY 1.0 (Turk 1994, "The PLY Polygon File Format"), text and binary of either byte order.
// Our own reader: that of assimp 5.2 overruns its buffers on broken files.
#pragma once

#include <filesystem>

#include "core/scene/files.h"
#include "core/scene/scene.h"

namespace tessera {

// One mesh of one material, white if there are vertex colours. Those are taken as sRGB, as the programs that
// write them show them; polygons as convex. Throws InputError, at `where` if the file is missing, at the file
// if its contents are wrong.
Scene read_ply(const std::filesystem::path& file, const ImportLimits& limits, std::string_view where = {});

}  // namespace tessera
