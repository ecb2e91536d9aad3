// SPDX-License-Identifier: Apache-2.0
// The nodes of a glTF file: what stands where, and how it moves. Only for the files of this folder.
#pragma once

#include "core/scene/gltf/document.h"

namespace tessera::gltf {

// Adds an object for each node with a mesh, instances, tracks, cameras and lights. `first_mesh` is what
// add_meshes returned.
void add_nodes(Scene& scene, const Document&, const std::vector<int>& first_mesh);

}  // namespace tessera::gltf
