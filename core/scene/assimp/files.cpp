// SPDX-License-Identifier: Apache-2.0
#include "core/scene/assimp/files.h"

#include <assimp/MemoryIOWrapper.h>
#include <fmt/format.h>

#include "core/scene/files.h"
#include "core/scene/mtl.h"
#include "core/scene/roots.h"

namespace tessera::assimp {
namespace {

constexpr std::uint64_t kMaxMtlBytes = 64ull << 20;

Assimp::IOStream* stream_of(const std::string& text) {
  return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace

bool CheckedFiles::is_library(const char* name) const {
  std::error_code error;
  return extension_of(file_) == ".obj" && std::filesystem::is_regular_file(name, error);
}

bool CheckedFiles::Exists(const char* name) const { return is_itself(name) || is_library(name); }

Assimp::IOStream* CheckedFiles::Open(const char* name, const char*) {
  if (is_itself(name)) return stream_of(bytes_);
  const std::string shown = std::filesystem::path(name).filename().string();
  if (!is_library(name)) {
    libraries_.warnings.push_back(fmt::format("there is no material library '{}'", shown));
    return nullptr;
  }
  const std::filesystem::path library = within(roots_, name, file_.string());
  CheckedMtl mtl = checked_mtl(read_file(library, kMaxMtlBytes));
  libraries_.files.push_back(library.string());
  for (const std::string& text : mtl.warnings)
    libraries_.warnings.push_back(fmt::format("{}:{}", shown, text));
  libraries_.physical.merge(mtl.physical);
  texts_.push_back(std::move(mtl.text));
  return stream_of(texts_.back());
}

}  // namespace tessera::assimp
