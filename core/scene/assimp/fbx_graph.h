// SPDX-License-Identifier: Apache-2.0
// What hangs below what in an FBX file. assimp follows it by recursion. Only for the files of this folder.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::assimp {

class FbxGraph {
 public:
  void connect(const std::string& child, const std::string& parent) { parents_[child].push_back(parent); }

  // Throws InputError at `file` if an object is below itself, or below more than `depth` others.
  void check(std::uint64_t depth, const std::string& file) const;

 private:
  std::map<std::string, std::vector<std::string>> parents_;
};

// Adds the connections ("C" records) of a text FBX. Throws InputError at `file` if braces nest too deeply, or
// if a record lacks the value that assimp takes for granted.
void read_text_connections(FbxGraph& graph, std::string_view text, const std::string& file);

}  // namespace tessera::assimp
