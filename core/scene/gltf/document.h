// SPDX-License-Identifier: Apache-2.0
// A glTF file as tinygltf parses it, and the bytes in it, every access checked. Only for the files of this
// folder.
#pragma once

#include <tiny_gltf.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace tessera::gltf {

struct Document {
  std::filesystem::path file;
  tinygltf::Model model;

  // Throws InputError at "file#part", for instance "a.glb#meshes/3".
  [[noreturn]] void refuse(std::string_view part, std::string_view what,
                           std::string_view accepted = {}) const;
};

// Throws InputError unless the file can be parsed and needs no extension we lack. Images stay encoded.
Document open(const std::filesystem::path& file, std::string_view where);

// The bytes of a buffer view.
std::span<const unsigned char> bytes_of(const Document&, int buffer_view);

// The encoded bytes of an image: embedded, or of its file.
std::span<const unsigned char> image_bytes(const Document&, int image);

// Elements of an accessor as floats, `width` of them one after the other; normalized integers become -1..1 or
// 0..1 (glTF 2.0, section 3.6.2.3). `types` are the TINYGLTF_TYPE_ that are accepted.
struct Floats {
  int width = 0;
  std::vector<float> values;
  std::size_t count() const { return width == 0 ? 0 : values.size() / static_cast<std::size_t>(width); }
};
Floats floats_of(const Document&, int accessor, std::initializer_list<int> types);

// The elements of a scalar accessor of unsigned integers, each below `end`.
std::vector<std::uint32_t> indices_of(const Document&, int accessor, std::size_t end);

}  // namespace tessera::gltf
