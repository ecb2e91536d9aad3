// SPDX-License-Identifier: Apache-2.0
// A file as its format's reader understands it, and scenes put together from several. What comes out is not
// checked yet: load_scene does that (finish.h).
#pragma once

#include <array>
#include <filesystem>

#include "core/scene/limits.h"
#include "core/scene/scene.h"

namespace tessera {

// How far scenes that import scenes may still go: how deep, how many files, and what those may hold.
struct ImportBudget {
  ImportLimits limits;  // of a file alone: file_bytes, node_depth; the others are what is left
  std::uint64_t depth = limits.depth;
  int files = 10'000;
};

// Dispatches on the extension. `where` is the place that names the file, for messages; empty: the file
// itself.
Scene import_scene(const std::filesystem::path& file, ImportBudget& budget, std::string_view where = {});

// All textures of a material, unset ones too.
std::array<Texture*, 11> textures_of(Material&);

// The light group of that name, added if new; -1 for an empty name. Throws InputError at `where` if there are
// more than kMaxLightGroups.
int light_group(Scene&, const std::string& name, std::string_view where);

// Moves everything of `part` but its environment, background and frame rate to the end of `scene`,
// transformed. Powers stay as they are under scaling. Adds a warning for what cannot be transformed exactly.
void append(Scene& scene, Scene&& part, const Matrix& transform);

// Adds a warning unless it is there already. Keeps a list of bounded length.
void warn(Scene& scene, std::string text);

// (x, y, z) of a world whose Z points up to (x, z, -y).
Matrix z_up_to_y_up();

}  // namespace tessera
