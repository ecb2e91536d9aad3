// SPDX-License-Identifier: Apache-2.0
// Where converted textures lie: a folder that outlives the process, so that a picture is converted once.
#pragma once

#include <filesystem>
#include <string>

namespace tessera::tracer {

class TextureFolder {
 public:
  // `given`, or if it is empty $TESSERA_TEXTURE_CACHE: made if it is missing, and a folder that cannot be
  // written is an Error. If neither is set: tessera/textures in $XDG_CACHE_HOME or ~/.cache, or, if that
  // cannot be written, a temporary folder that is removed with this object; warning() then says so.
  explicit TextureFolder(const std::filesystem::path& given);
  ~TextureFolder();
  TextureFolder(const TextureFolder&) = delete;
  TextureFolder& operator=(const TextureFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::string& warning() const { return warning_; }  // empty: none

 private:
  std::filesystem::path path_;
  std::string warning_;
  bool temporary_ = false;
};

}  // namespace tessera::tracer
