// SPDX-License-Identifier: Apache-2.0
#include "core/bundle.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/error.h"

namespace tessera {
namespace {

constexpr std::string_view kTitle = "tessera bundle 1";
constexpr std::size_t kMaxPart = 255;

[[noreturn]] void refuse(std::string_view what, std::string_view accepted = {}) {
  throw InputError("bundle", what, accepted);
}

bool is_part(std::string_view part) {
  return !part.empty() && part.size() <= kMaxPart && part != "." && part != "..";
}

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

const Bundle::File* find(const Bundle& bundle, std::string_view path) {
  const auto at = std::ranges::lower_bound(bundle.files, path, {}, &Bundle::File::path);
  return at != bundle.files.end() && at->path == path ? &*at : nullptr;
}

void require_no_file_above(const Bundle& bundle, std::string_view path) {
  for (std::size_t at = path.find('/'); at != path.npos; at = path.find('/', at + 1))
    if (find(bundle, path.substr(0, at)))
      refuse(fmt::format("'{}' is a file and a folder", path.substr(0, at)));
}

void validate(const Bundle::File& file) {
  if (!is_bundle_path(file.path))
    refuse(fmt::format("a file cannot be called '{}'", file.path),
           "relative paths of at most 1024 bytes without '.', '..', empty parts and control characters");
  if (!is_digest(file.digest)) refuse(fmt::format("'{}' has no digest", file.path));
}

// Takes what is before the next `end` off the front of the text.
std::string_view take(std::string_view& text, char end) {
  const std::size_t at = text.find(end);
  if (at == text.npos) refuse("is cut off");
  const std::string_view taken = text.substr(0, at);
  text.remove_prefix(at + 1);
  return taken;
}

std::uint64_t number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) refuse("a size is no number");
  return value;
}

}  // namespace

bool is_bundle_path(std::string_view path) {
  if (path.empty() || path.size() > kMaxBundlePath || std::ranges::any_of(path, is_control)) return false;
  for (std::size_t at = 0;;) {
    const std::size_t end = path.find('/', at);
    if (!is_part(path.substr(at, end - at))) return false;
    if (end == path.npos) return true;
    at = end + 1;
  }
}

void validate(const Bundle& bundle) {
  if (bundle.files.size() > kMaxBundleFiles)
    refuse(fmt::format("there are {} files", bundle.files.size()),
           fmt::format("at most {}", kMaxBundleFiles));
  std::uint64_t left = kMaxBundleBytes;
  for (const Bundle::File& file : bundle.files) {
    validate(file);
    if (file.bytes > left) refuse("the files are too large", "at most 1 TiB in all");
    left -= file.bytes;
  }
  const auto out_of_order = [](const auto& a, const auto& b) { return a.path >= b.path; };
  if (const auto at = std::ranges::adjacent_find(bundle.files, out_of_order); at != bundle.files.end())
    refuse(fmt::format("'{}' is there twice or out of order", std::next(at)->path));
  for (const Bundle::File& file : bundle.files) require_no_file_above(bundle, file.path);
  if (!find(bundle, bundle.scene)) refuse(fmt::format("its scene file '{}' is not in it", bundle.scene));
}

std::string to_text(const Bundle& bundle) {
  std::string text = fmt::format("{}\n{}\n", kTitle, bundle.scene);
  for (const Bundle::File& file : bundle.files)
    fmt::format_to(std::back_inserter(text), "{} {} {}\n", file.digest, file.bytes, file.path);
  return text;
}

Bundle parse_bundle(std::string_view text) {
  if (text.size() > kMaxBundleText) refuse("is too long", "at most 64 MiB");
  std::string_view rest = text;
  if (take(rest, '\n') != kTitle) refuse("is none", kTitle);
  Bundle bundle;
  bundle.scene = take(rest, '\n');
  while (!rest.empty()) {
    if (bundle.files.size() == kMaxBundleFiles) refuse("there are too many files", "at most 100000");
    std::string_view line = take(rest, '\n');
    const std::string_view digest = take(line, ' '), bytes = take(line, ' ');
    bundle.files.push_back({std::string(line), std::string(digest), number(bytes)});
  }
  validate(bundle);
  if (to_text(bundle) != text) refuse("is not written as it must be");
  return bundle;
}

}  // namespace tessera
