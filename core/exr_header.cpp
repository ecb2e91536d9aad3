// SPDX-License-Identifier: Apache-2.0
#include "core/exr_header.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

namespace tessera {
namespace {

constexpr std::size_t kStart = 8;                    // the magic number and the version
constexpr unsigned char kManyParts = 0x10;           // of the version's second byte
constexpr std::size_t kSize = sizeof(std::int32_t);  // little-endian, as this machine is

// Removes a text and the 0 after it; none if there is no such end.
std::optional<std::string_view> take_text(std::string_view& left) {
  const std::size_t end = left.find('\0');
  if (end == left.npos) return std::nullopt;
  const std::string_view text = left.substr(0, end);
  left.remove_prefix(end + 1);
  return text;
}

std::int64_t number_at(std::string_view bytes, std::size_t i) {
  std::int32_t value = 0;
  std::memcpy(&value, bytes.data() + i * sizeof value, sizeof value);
  return value;
}

// Bytes of attributes of one length, which OpenEXR reads whatever size they state: behind another one it would take
// anything for the next attribute, and make room for what that states.
constexpr std::pair<std::string_view, std::size_t> kLengths[] = {
    {"box2f", 16},         {"box2i", 16},  {"chromaticities", 32}, {"compression", 1},
    {"deepImageState", 1}, {"double", 8},  {"envmap", 1},          {"float", 4},
    {"int", 4},            {"keycode", 28}, {"lineOrder", 1},      {"m33d", 72},
    {"m33f", 36},          {"m44d", 128},  {"m44f", 64},           {"rational", 8},
    {"tiledesc", 9},       {"timecode", 8}, {"v2d", 16},           {"v2f", 8},
    {"v2i", 8},            {"v3d", 24},    {"v3f", 12},            {"v3i", 12}};

// Whether a list of channels ends where its attribute does: a name, 16 bytes, and so on, up to an empty name.
bool is_channel_list(std::string_view value) {
  constexpr std::size_t kChannel = 16;
  while (true) {
    const auto name = take_text(value);
    if (!name) return false;
    if (name->empty()) return value.empty();
    if (value.size() < kChannel) return false;
    value.remove_prefix(kChannel);
  }
}

// Whether a value of the type takes as many bytes as its attribute states.
bool length_fits(std::string_view type, std::string_view value) {
  if (type == "chlist") return is_channel_list(value);
  if (type == "preview")
    return value.size() >= 2 * kSize && number_at(value, 0) >= 0 && number_at(value, 1) >= 0 &&
           static_cast<std::int64_t>(value.size() - 2 * kSize) == 4 * number_at(value, 0) * number_at(value, 1);
  const auto known = std::ranges::find(kLengths, type, [](const auto& length) { return length.first; });
  return known == std::end(kLengths) || known->second == value.size();
}

bool size_fits(std::string_view name, std::string_view value, std::int64_t most_edge) {
  const auto fits = [&](std::int64_t edge) { return edge >= 1 && edge <= most_edge; };
  if (name == "dataWindow" && value.size() == 4 * kSize)
    return fits(number_at(value, 2) - number_at(value, 0) + 1) &&
           fits(number_at(value, 3) - number_at(value, 1) + 1);
  if (name == "tiles" && value.size() > 2 * kSize)
    return fits(number_at(value, 0)) && fits(number_at(value, 1));
  return true;
}

}  // namespace

ExrHeaders exr_headers(std::string_view bytes, std::uintmax_t file_bytes, int most_edge) {
  if (bytes.size() < kStart || !bytes.starts_with("\x76\x2f\x31\x01")) return ExrHeaders::fit;
  const bool many = (static_cast<unsigned char>(bytes[5]) & kManyParts) != 0;
  const ExrHeaders at_end = bytes.size() >= file_bytes ? ExrHeaders::lie : ExrHeaders::longer;
  std::string_view left = bytes.substr(kStart);
  int parts = 0;
  bool first = true;  // attribute of its header
  while (!left.empty()) {
    if (left[0] == '\0') {
      if (first || !many) return ExrHeaders::fit;
      first = true;
      left.remove_prefix(1);
      continue;
    }
    if (first && ++parts > kMostExrParts) return ExrHeaders::too_many;
    first = false;
    const auto name = take_text(left);
    const auto type = name ? take_text(left) : std::nullopt;
    if (!type || left.size() < kSize) return at_end;
    const std::int64_t size = number_at(left, 0);
    left.remove_prefix(kSize);
    const std::uintmax_t behind = file_bytes - (bytes.size() - left.size());
    if (size < 0 || static_cast<std::uintmax_t>(size) > behind) return ExrHeaders::lie;
    if (static_cast<std::size_t>(size) > left.size()) return at_end;
    const std::string_view value = left.substr(0, static_cast<std::size_t>(size));
    if (!length_fits(*type, value) || (most_edge > 0 && !size_fits(*name, value, most_edge)))
      return ExrHeaders::lie;
    left.remove_prefix(static_cast<std::size_t>(size));
  }
  return at_end;
}

bool exr_header_fits(std::string_view bytes, std::uintmax_t file_bytes, int most_edge) {
  const ExrHeaders found = exr_headers(bytes, file_bytes, most_edge);
  return found == ExrHeaders::fit || found == ExrHeaders::longer;
}

}  // namespace tessera
