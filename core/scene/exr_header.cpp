// SPDX-License-Identifier: Apache-2.0
#include "core/scene/exr_header.h"

#include <cstdint>
#include <cstring>

namespace tessera {
namespace {

constexpr std::size_t kStart = 8;                    // the magic number and the version
constexpr unsigned char kManyParts = 0x10;           // of the version's second byte
constexpr std::size_t kSize = sizeof(std::int32_t);  // little-endian, as this machine is

// Removes a text and the 0 after it; false if there is none.
bool skip_text(std::string_view& left) {
  const std::size_t end = left.find('\0');
  if (end == left.npos) return false;
  left.remove_prefix(end + 1);
  return true;
}

}  // namespace

bool exr_attributes_fit(std::string_view bytes) {
  if (bytes.size() < kStart) return true;
  const bool many = (static_cast<unsigned char>(bytes[5]) & kManyParts) != 0;
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
    if (!skip_text(left) || !skip_text(left) || left.size() < kSize) return false;
    std::int32_t size = 0;
    std::memcpy(&size, left.data(), kSize);
    left.remove_prefix(kSize);
    if (size < 0 || static_cast<std::size_t>(size) > left.size()) return false;
    left.remove_prefix(static_cast<std::size_t>(size));
  }
  return false;
}

}  // namespace tessera
