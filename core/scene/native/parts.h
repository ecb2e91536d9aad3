// SPDX-License-Identifier: Apache-2.0
// The parts of a native scene file that stand for themselves: each turns one object into data or adds it.
#pragma once

#include "core/scene/native/node.h"
#include "core/scene/pictures.h"

namespace tessera {

Camera read_camera(const Node& node);
void add_light(Scene& scene, const Node& node);
Environment read_environment(const Node& node, PictureShelf& shelf);

// Sets the fields that `node` gives.
void override_material(Material& material, const Node& node, PictureShelf& shelf);

// A mesh whose triangles stand in the file. The material is not looked at.
Mesh read_mesh(const std::string& name, const Node& node);

}  // namespace tessera
