// SPDX-License-Identifier: Apache-2.0
#include "core/scene/roots.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

bool is_below(const fs::path& folder, const fs::path& file) {
  const auto [end, at] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return end == folder.end() || (std::next(end) == folder.end() && end->empty());
}

fs::path by_name(const fs::path& path) { return fs::absolute(path).lexically_normal(); }

fs::path by_links(const fs::path& path) {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(path, error);
  return error ? fs::path() : real;
}

}  // namespace

bool lies_within(const std::vector<fs::path>& roots, const fs::path& file) {
  if (roots.empty()) return true;
  const fs::path name = by_name(file), real = by_links(name);
  return std::ranges::any_of(roots, [&](const fs::path& root) { return is_below(by_name(root), name); }) &&
         std::ranges::any_of(roots, [&](const fs::path& root) { return is_below(by_links(root), real); });
}

fs::path within(const std::vector<fs::path>& roots, const fs::path& file, std::string_view where) {
  if (roots.empty()) return file;
  if (lies_within(roots, file)) return file.lexically_normal();
  std::vector<std::string> names;
  for (const fs::path& root : roots) names.push_back(by_name(root).string());
  const std::string name = file.string();
  throw InputError(where.empty() ? name : fmt::format("{}: {}", where, name),
                   "lies outside of the folders that the scene's files may lie in, or a link leads there",
                   fmt::format("files below {}", fmt::join(names, ", ")));
}

}  // namespace tessera
