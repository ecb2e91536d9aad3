// SPDX-License-Identifier: Apache-2.0
#include "worker/render/texture_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <system_error>

#include "core/error.h"

namespace tessera::tracer {
namespace {

namespace fs = std::filesystem;

fs::path folder_in(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value ? fs::path(value) : fs::path();
}

// Where programs keep what they can make again, by the XDG Base Directory Specification 0.8; empty: nowhere.
fs::path standard_folder() {
  if (const fs::path cache = folder_in("XDG_CACHE_HOME"); cache.is_absolute())
    return cache / "tessera/textures";
  if (const fs::path home = folder_in("HOME"); !home.empty()) return home / ".cache/tessera/textures";
  return {};
}

// Why nothing can be written to a folder, which is made if it is missing; empty if it can.
std::string obstacle(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error && access(folder.c_str(), W_OK | X_OK) != 0) error = {errno, std::generic_category()};
  if (!error && !fs::is_directory(folder)) error = std::make_error_code(std::errc::not_a_directory);
  return error ? error.message() : std::string();
}

fs::path temporary_folder() {
  std::string pattern = (fs::temp_directory_path() / "tessera-textures-XXXXXX").string();
  if (!mkdtemp(pattern.data()))
    throw Error(ExitCode::internal_error,
                fmt::format("{}: {}", pattern, std::generic_category().message(errno)));
  return pattern;
}

}  // namespace

TextureFolder::TextureFolder(const fs::path& given)
    : path_(given.empty() ? folder_in("TESSERA_TEXTURE_CACHE") : given) {
  if (!path_.empty()) {
    if (const std::string why = obstacle(path_); !why.empty())
      throw Error(
          ExitCode::bad_usage,
          fmt::format("texture cache '{}': {}; accepted: a folder that can be written", path_.string(), why));
    return;
  }
  path_ = standard_folder();
  const std::string why = path_.empty() ? "neither XDG_CACHE_HOME nor HOME is set" : obstacle(path_);
  if (why.empty()) return;
  warning_ =
      fmt::format("texture cache '{}': {}; textures are converted anew every time", path_.string(), why);
  path_ = temporary_folder();
  temporary_ = true;
}

TextureFolder::~TextureFolder() {
  std::error_code ignored;
  if (temporary_) fs::remove_all(path_, ignored);
}

}  // namespace tessera::tracer
