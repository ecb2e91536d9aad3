// SPDX-License-Identifier: Apache-2.0
// Reads tessera's own scene files (docs/SCENE.md, docs/scene.schema.json).
#pragma once

#include <filesystem>

#include "core/scene/scene.h"

namespace tessera {

// `depth`: how many scene files import this one in turn. Throws InputError at `where` if there is no such
// file.
Scene read_native(const std::filesystem::path& file, int depth, std::string_view where = {});

}  // namespace tessera
