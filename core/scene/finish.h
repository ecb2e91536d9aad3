// SPDX-License-Identifier: Apache-2.0
// From what a file says to what load_scene promises: complete, in range and finite.
#pragma once

#include <string>

#include "core/scene/scene.h"

namespace tessera {

// Drops what cannot be rendered and pulls numbers into the ranges of scene.h, each with a warning; adds a
// camera if there is none. Throws InputError, naming `file`, if what is left would not be the scene meant.
void finish(Scene& scene, const std::string& file);

}  // namespace tessera
