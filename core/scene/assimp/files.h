// SPDX-License-Identifier: Apache-2.0
// What assimp gets to read: the file itself, and material libraries within the roots after a check (mtl.h).
// Nothing else.
// Only for the files of this folder.
#pragma once

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <deque>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace tessera::assimp {

// What the material libraries say that assimp does not hand on.
struct Libraries {
  std::vector<std::string> warnings;
  std::set<std::string> physical;  // materials with Pr or Pm
  std::vector<std::string> files;
};

class CheckedFiles : public Assimp::IOSystem {
 public:
  // `bytes` are those of `file`; `libraries` is borrowed.
  CheckedFiles(std::string bytes, std::filesystem::path file, std::vector<std::filesystem::path> roots,
               Libraries& libraries)
      : bytes_(std::move(bytes)), file_(std::move(file)), roots_(std::move(roots)), libraries_(libraries) {}

  bool Exists(const char* name) const override;
  char getOsSeparator() const override { return '/'; }
  void Close(Assimp::IOStream* stream) override { delete stream; }
  Assimp::IOStream* Open(const char* name, const char* mode) override;

 private:
  bool is_itself(const char* name) const { return file_.string() == name; }
  bool is_library(const char* name) const;

  std::string bytes_;
  std::filesystem::path file_;
  std::vector<std::filesystem::path> roots_;
  std::deque<std::string> texts_;
  Libraries& libraries_;
};

}  // namespace tessera::assimp
