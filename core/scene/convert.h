// SPDX-License-Identifier: Apache-2.0
// Scene files of any kind to our native format.
#pragma once

#include <filesystem>
#include <string>

#include "core/scene/limits.h"
#include "core/scene/scene.h"

namespace tessera {

struct Conversion {
  Scene scene;          // what was read
  bool whole = false;   // the new file holds everything but pictures; else it imports the old one
  std::string why_not;  // the reason if it is not whole
};

// Writes `to` so that it loads as the same scene, to the bit; it is loaded to make sure. Throws InputError if
// `from` cannot be read, or `to` would not be the same scene; then nothing is written.
Conversion convert_scene(const std::filesystem::path& from, const std::filesystem::path& to,
                         const ImportLimits& = {});

}  // namespace tessera
