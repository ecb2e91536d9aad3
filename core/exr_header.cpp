// SPDX-License-Identifier: Apache-2.0
#include "core/exr_header.h"

#include <cstdint>
#include <cstring>
#include <optional>

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

bool exr_header_fits(std::string_view bytes, std::uintmax_t file_bytes, int most_edge) {
  if (bytes.size() < kStart || !bytes.starts_with("\x76\x2f\x31\x01")) return true;
  const bool many = (static_cast<unsigned char>(bytes[5]) & kManyParts) != 0;
  const bool whole = bytes.size() >= file_bytes;  // then nothing can be beyond
  std::string_view left = bytes.substr(kStart);
  bool first = true;  // attribute of its header
  while (!left.empty()) {
    if (left[0] == '\0') {
      if (first || !many) return true;
      first = true;
      left.remove_prefix(1);
      continue;
    }
    first = false;
    const auto name = take_text(left);
    if (!name || !take_text(left) || left.size() < kSize) return !whole;
    std::int32_t size = 0;
    std::memcpy(&size, left.data(), kSize);
    left.remove_prefix(kSize);
    const std::uintmax_t behind = file_bytes - (bytes.size() - left.size());
    if (size < 0 || static_cast<std::uintmax_t>(size) > behind) return false;
    if (static_cast<std::size_t>(size) > left.size()) return true;
    if (most_edge > 0 && !size_fits(*name, left.substr(0, static_cast<std::size_t>(size)), most_edge))
      return false;
    left.remove_prefix(static_cast<std::size_t>(size));
  }
  return !whole;
}

}  // namespace tessera
