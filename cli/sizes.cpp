// SPDX-License-Identifier: Apache-2.0
#include "cli/sizes.h"

#include <fmt/format.h>

#include <charconv>

#include "cli/picture_options.h"
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

Size tile_size_option(std::string_view text) {
  const std::optional<Size> tile = parse_tile_size(text);
  if (!tile) refuse_option("--tile-size", text, fmt::format("N or WxH, each 1 to {}", kMaxEdge));
  return *tile;
}

}  // namespace tessera
