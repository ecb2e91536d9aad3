// SPDX-License-Identifier: Apache-2.0
// The meshes of a glTF file, one of ours for each primitive, and the materials that variants choose for them.
// Only for the files of this folder.
#pragma once

#include "core/scene/gltf/document.h"

namespace tessera::gltf {

// Adds all meshes and Scene::variants; the materials are there (materials.h). Returns the index of the first
// of our meshes for each mesh of the document, and one more: the end.
std::vector<int> add_meshes(Scene& scene, const Document&);

}  // namespace tessera::gltf
