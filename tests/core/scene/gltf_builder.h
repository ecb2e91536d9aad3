// SPDX-License-Identifier: Apache-2.0
// glTF files put together piece by piece, written as .glb.
#pragma once

#include <nlohmann/json.hpp>
#include <type_traits>
#include <vector>

#include "tests/core/scene/glb.h"

namespace tessera {

struct GltfBuilder {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
  std::string binary;

  // Adds an element to a list of the document; its index.
  int add(const char* list, nlohmann::json item) {
    json[list].push_back(std::move(item));
    return static_cast<int>(json[list].size()) - 1;
  }

  int view(const std::string& bytes) {
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    const std::size_t offset = binary.size();
    binary += bytes;
    return add("bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
  }

  template <class T>
  static std::string bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
  }

  template <class T>
  static int component() {
    if (std::is_same_v<T, std::int8_t>) return 5120;
    if (std::is_same_v<T, std::uint8_t>) return 5121;
    if (std::is_same_v<T, std::int16_t>) return 5122;
    if (std::is_same_v<T, std::uint16_t>) return 5123;
    if (std::is_same_v<T, std::uint32_t>) return 5125;
    return 5126;
  }

  static std::size_t width(const std::string& type) {
    return type == "SCALAR" ? 1u : std::size_t(type[3] - '0');
  }

  // An accessor of packed elements in a view of their own.
  template <class T>
  int accessor(const std::vector<T>& values, const std::string& type, bool normalized = false) {
    return add("accessors", {{"bufferView", view(bytes_of(values))},
                             {"componentType", component<T>()},
                             {"normalized", normalized},
                             {"count", values.size() / width(type)},
                             {"type", type}});
  }

  // A mesh of one primitive, without a node.
  int mesh(nlohmann::json primitive) { return add("meshes", {{"primitives", {std::move(primitive)}}}); }
  // The accessor of the corners (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0).
  int square() { return accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3"); }
  int triangle_mesh() {
    return mesh({{"attributes", {{"POSITION", accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")}}}});
  }

  std::string bytes() const {
    nlohmann::json whole = json;
    if (!binary.empty() && !whole.contains("buffers")) whole["buffers"] = {{{"byteLength", binary.size()}}};
    return glb_of(whole.dump(), binary);
  }

  Scene load() const {
    const Folder folder;
    return load_scene(folder.write("built.glb", bytes()));
  }
  std::string refused() const {
    const Folder folder;
    return refusal(folder.write("built.glb", bytes()));
  }
};

}  // namespace tessera
