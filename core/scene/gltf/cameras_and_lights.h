// SPDX-License-Identifier: Apache-2.0
// The cameras of a glTF file and the lights of KHR_lights_punctual. Only for the files of this folder.
#pragma once

#include "core/scene/gltf/document.h"

namespace tessera::gltf {

// The camera of a node, not placed yet.
Camera camera_of(const Document&, const tinygltf::Node&);

// Adds the light that the extension of a node refers to, where the node stands.
void add_light(Scene& scene, const Document&, const tinygltf::Value& extension, const Matrix& world,
               const std::string& part);

}  // namespace tessera::gltf
