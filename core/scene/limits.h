// SPDX-License-Identifier: Apache-2.0
// How much a scene from elsewhere may ask for before it is refused.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/scene.h"

namespace tessera {

// What all that one scene file takes in may come to. A hostile file is refused here, before it eats the
// machine.
struct ImportLimits {
  std::uint64_t file_bytes = 4000ull << 20;   // of one file, together with the buffers that it names
  std::uint64_t vertices = 1ull << 28;        // of all meshes
  std::uint64_t triangles = 1ull << 29;       // of all meshes, each counted once
  std::uint64_t instances = 16'000'000;       // and spheres, quads and disks
  std::uint64_t picture_pixels = 1ull << 31;  // of all pictures
  std::uint64_t node_depth = 1000;            // of parents above a node
  std::uint64_t depth = 8;                    // of scenes that import scenes
  // Files outside of these folders are refused, and names are taken without "..": see roots.h. Empty: none.
  std::vector<std::filesystem::path> roots = {};
  bool operator==(const ImportLimits&) const = default;
};

// Sets the field of that name. Throws Error(bad_usage) listing the names if there is none.
void set_limit(ImportLimits&, std::string_view name, std::uint64_t value);

std::vector<std::string_view> limit_names();

// Adds up what a scene that grows holds; what it has counted it does not look at again.
class Tally {
 public:
  explicit Tally(const ImportLimits& limits) : limits_(limits) {}

  // Throws InputError at `where` if the scene holds more than the limits allow.
  void count(const Scene&, std::string_view where);

 private:
  ImportLimits limits_;
  std::size_t meshes_ = 0, pictures_ = 0;  // counted so far
  std::uint64_t vertices_ = 0, triangles_ = 0, pixels_ = 0;
};

}  // namespace tessera
