// SPDX-License-Identifier: Apache-2.0
// Whole files in memory, how they are called in messages, and how much a scene may hold.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace tessera {

// The bytes of `file`. Throws InputError, at `where` or else at the file's name, if there is no such regular
// file, it cannot be read, or it is longer than `most` bytes.
std::string read_file(const std::filesystem::path& file, std::uint64_t most, std::string_view where = {});

// What all that one scene file takes in may come to. A hostile file is refused here, before it eats the
// machine.
struct ImportLimits {
  std::uint64_t file_bytes = std::uint64_t{4} << 30;  // of one file together with the buffers that it names
  std::uint64_t vertices = std::uint64_t{1} << 28;    // of all meshes
  std::uint64_t triangles = std::uint64_t{1} << 29;   // of all meshes
  std::uint64_t instances = 16'000'000;               // of meshes
  std::uint64_t picture_pixels = std::uint64_t{1} << 31;  // of all pictures
  std::uint64_t node_depth = 1000;                        // of parents above a node
};

// Throws InputError at `where` if there are more than `most` of `things`.
void require_at_most(std::uint64_t most, std::uint64_t count, std::string_view things,
                     std::string_view where);

// Lower case, with the dot: ".gltf".
std::string extension_of(const std::filesystem::path& file);

}  // namespace tessera
