// SPDX-License-Identifier: Apache-2.0
// Members of the JSON objects that tinygltf leaves as they are: extensions. Only for the files of this
// folder.
#pragma once

#include <tiny_gltf.h>

#include <Imath/ImathColor.h>

#include <optional>
#include <string>

#include "core/scene/scene.h"

namespace tessera::gltf {

// The object of that name; nullptr if there is none.
const tinygltf::Value* find(const tinygltf::ExtensionMap&, const std::string& name);
const tinygltf::Value* find(const tinygltf::Value&, const std::string& key);

// The member `key` if it is a number, and in the range of an int where one is asked for.
std::optional<double> number(const tinygltf::Value&, const std::string& key);
std::optional<int> integer(const tinygltf::Value&, const std::string& key);
std::optional<int> integer(const tinygltf::Value&);
std::optional<std::string> text(const tinygltf::Value&, const std::string& key);

// The member `key`, or `otherwise` if it is no number, or not an array of at least as many.
float number_or(const tinygltf::Value&, const std::string& key, float otherwise);
Color color_or(const tinygltf::Value&, const std::string& key, const Color& otherwise);
Vec2 vec2_or(const tinygltf::Value&, const std::string& key, const Vec2& otherwise);

}  // namespace tessera::gltf
