// SPDX-License-Identifier: Apache-2.0
#include "core/scene/bundle_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "core/error.h"
#include "core/scene/load.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

// By a name that is not absolute, so that a file's name is so only if that is how the scene names it.
fs::path relative_name(const fs::path& file) {
  const fs::path name = file.is_absolute() ? file.lexically_relative(fs::current_path()) : file;
  return name.lexically_normal();
}

fs::path common_folder(const fs::path& a, const fs::path& b) {
  fs::path common;
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end() && *i == *j; ++i, ++j) common /= *i;
  return common;
}

void require_relative(const fs::path& file) {
  if (file.is_absolute())
    throw InputError(file.string(), "the scene names this file by an absolute path",
                     "paths relative to the file that names it");
}

Bundle::File described(const std::string& path, const fs::path& source) {
  std::ifstream in(source, std::ios::binary);
  Bundle::File file{path, {}, 0};
  Sha256 digest;
  std::vector<char> piece(1 << 20);
  while (in) {
    in.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    digest.add(piece.data(), static_cast<std::size_t>(in.gcount()));
    file.bytes += static_cast<std::uint64_t>(in.gcount());
  }
  if (!in.eof()) throw InputError(source.string(), "cannot be read");
  file.digest = digest.hex();
  return file;
}

}  // namespace

BundledScene load_bundled(const fs::path& scene_file, const std::vector<fs::path>& roots,
                          ImportLimits limits) {
  const fs::path file = relative_name(scene_file);
  limits.roots = {file.has_parent_path() ? file.parent_path() : fs::path(".")};
  limits.roots.insert(limits.roots.end(), roots.begin(), roots.end());
  BundledScene result{load_scene(file, limits), {}, {}};
  std::vector<fs::path> names;
  for (const std::string& name : result.scene.files) {
    require_relative(name);
    names.push_back(fs::absolute(name).lexically_normal());
  }
  fs::path top = names.front().parent_path();
  for (const fs::path& name : names) top = common_folder(top, name.parent_path());
  std::map<std::string, fs::path> files;
  for (const fs::path& name : names) files[name.lexically_relative(top).string()] = name;
  for (const auto& [path, source] : files) {
    result.bundle.files.push_back(described(path, source));
    result.sources.push_back(source);
  }
  result.bundle.scene = names.front().lexically_relative(top).string();
  validate(result.bundle);
  return result;
}

}  // namespace tessera
