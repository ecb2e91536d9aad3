// SPDX-License-Identifier: Apache-2.0
// Reads tessera's own scene files (docs/SCENE.md, docs/scene.schema.json).
#pragma once

#include <filesystem>

#include "core/scene/import.h"

namespace tessera {

// Throws InputError at `where` if there is no such file. `budget` is what is left for files that it imports.
Scene read_native(const std::filesystem::path& file, ImportBudget& budget, std::string_view where = {});

}  // namespace tessera
