// SPDX-License-Identifier: Apache-2.0
// Binary glTF files made from text ones (glTF 2.0, section 4.4).
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

#include "tests/core/scene/folder.h"

namespace tessera {

inline std::string bytes_of_word(std::uint32_t v) {
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &v, 4);
  return bytes;
}

inline std::string glb_of(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string chunks = bytes_of_word(static_cast<std::uint32_t>(json.size())) + "JSON" + json;
  if (!binary.empty())
    chunks += bytes_of_word(static_cast<std::uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
  return "glTF" + bytes_of_word(2) + bytes_of_word(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

// A triangle whose vertices and texture lie in the binary chunk.
inline std::string glb_with_embedded_image() {
  const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::string image = contents(kData / "corners.png");
  const std::string binary = std::string(reinterpret_cast<const char*>(positions), 36) + image;
  const std::string json =
      R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
    "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    "textures": [{"source": 0}], "images": [{"bufferView": 1, "mimeType": "image/png"}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": )" +
      std::to_string(image.size()) + R"(}], "buffers": [{"byteLength": )" + std::to_string(binary.size()) +
      "}]}";
  return glb_of(json, binary);
}

}  // namespace tessera
