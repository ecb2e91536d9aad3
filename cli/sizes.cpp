// SPDX-License-Identifier: Apache-2.0
#include "cli/sizes.h"

#include <charconv>

#include "core/job.h"

namespace tessera {

std::optional<Size> parse_tile_size(std::string_view text) {
  Size size;
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  if (width.ec != std::errc{}) return std::nullopt;
  size.height = size.width;
  const char* rest = width.ptr;
  if (rest != end) {
    if (*rest != 'x') return std::nullopt;
    const auto height = std::from_chars(rest + 1, end, size.height);
    if (height.ec != std::errc{} || height.ptr != end) return std::nullopt;
  }
  const auto fits = [](int edge) { return edge >= 1 && edge <= kMaxEdge; };
  return fits(size.width) && fits(size.height) ? std::optional(size) : std::nullopt;
}

}  // namespace tessera
