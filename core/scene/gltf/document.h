// SPDX-License-Identifier: Apache-2.0
// A glTF file: its structure as tinygltf parses it, and its bytes, which are fetched here under limits, every
// access checked. Only for the files of this folder.
#pragma once

#include <tiny_gltf.h>

#include <deque>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/scene/files.h"
#include "core/scene/limits.h"
#include "core/scene/scene.h"

namespace tessera::gltf {

using Bytes = std::span<const unsigned char>;

struct Image {
  std::filesystem::path file;  // empty: it lies in the document
  int buffer_view = -1;        // used if >= 0
  Bytes bytes;                 // else, of a data URI
};

struct Document {
  std::filesystem::path file;
  ImportLimits limits;
  tinygltf::Model model;  // without buffers and images
  std::vector<Bytes> buffers;
  std::vector<Image> images;
  std::map<int, std::string> decoded;  // bytes of buffer views that were compressed (meshopt.h)
  std::deque<std::string> storage;     // owns what is not a file of its own
  std::vector<std::string> files;      // that were read into it; the first is `file`
  std::uint64_t bytes = 0;             // in storage and decoded

  // Throws InputError at "file#part", for instance "a.glb#meshes/3".
  [[noreturn]] void refuse(std::string_view part, std::string_view what,
                           std::string_view accepted = {}) const;
  void warn(Scene& scene, std::string_view what) const;  // "file: what"
  // A warning for each extension that this program does not understand.
  void warn_of_unknown(Scene& scene, const tinygltf::ExtensionMap&) const;

  // Reads a file to the end of `storage`, if limits.roots and limits.file_bytes allow it.
  void read(const std::filesystem::path& file, std::string_view where);
  // Counts bytes against limits.file_bytes.
  void take(std::uint64_t more);
};

// Throws InputError unless the file can be parsed and needs no extension we lack. Images stay encoded.
Document open(const std::filesystem::path& file, const ImportLimits& limits, std::string_view where);

// The bytes of a buffer view.
Bytes bytes_of(const Document&, int buffer_view);
// Those of a buffer from byte `offset` on. `part` is what names them, for messages.
Bytes bytes_of(const Document&, int buffer, std::uint64_t offset, std::uint64_t length,
               std::string_view part);

// Throws InputError "there is no <thing>" at `part` unless 0 <= index < size; the index.
std::size_t checked(const Document&, int index, std::size_t size, std::string_view thing,
                    std::string_view part);

}  // namespace tessera::gltf
