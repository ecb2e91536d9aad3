// SPDX-License-Identifier: Apache-2.0
// A scene together with the files that it is made from: what is handed in to a farm.
#pragma once

#include <filesystem>
#include <vector>

#include "core/bundle.h"
#include "core/scene/limits.h"
#include "core/scene/scene.h"

namespace tessera {

struct BundledScene {
  Scene scene;
  Bundle bundle;
  std::vector<std::filesystem::path> sources;  // of bundle.files, in their order
};

// Loads the scene and bundles the files that were read for it, those and no others, under the names that they
// have below their deepest common folder: so they find each other where they are unpacked. They must lie
// within the folder of the scene file or one of `roots`, by their names and by where links lead, and must not
// be named by absolute paths: throws InputError with the file's name and what is accepted. So does a file
// that cannot be read, and a scene that cannot be loaded.
BundledScene load_bundled(const std::filesystem::path& scene_file,
                          const std::vector<std::filesystem::path>& roots = {}, ImportLimits limits = {});

}  // namespace tessera
