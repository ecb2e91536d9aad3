// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file: what its numbers are. Only for ply.cpp.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::ply {

inline constexpr std::string_view kAccepted = "Stanford PLY 1.0";

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> count;  // of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Format { text, little, big };

struct Header {
  Format format = Format::text;
  std::vector<Element> elements;
  std::string picture;   // of "comment TextureFile", as MeshLab writes it
  std::size_t size = 0;  // bytes
};

// Throws InputError at `file` unless the header is whole and promises no more items than the file has bytes.
Header read_header(std::string_view bytes, const std::string& file);

}  // namespace tessera::ply
