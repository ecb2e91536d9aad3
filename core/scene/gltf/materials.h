// SPDX-License-Identifier: Apache-2.0
// The materials and textures of a glTF file. Only for the files of this folder.
#pragma once

#include "core/scene/gltf/document.h"
#include "core/scene/scene.h"

namespace tessera::gltf {

// Adds all materials of the document, in its order, and one more: what a primitive without a material gets.
void add_materials(Scene& scene, const Document&);

}  // namespace tessera::gltf
