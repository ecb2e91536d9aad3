// SPDX-License-Identifier: Apache-2.0
// `tessera compare`: how far an image is from a reference, in numbers and as a heat map.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>

#include "core/region.h"

namespace CLI {
class App;
}

namespace tessera {

struct CompareOptions {
  std::filesystem::path image, reference;
  std::string tile_size;  // N or WxH; empty: the image's tessera/tile, else 256
  float exposure = 0;     // in stops, of the display metrics (SSIM)
  bool json = false;
  std::filesystem::path heat_map;  // PNG to write; empty: none
  std::filesystem::path
      sheet;  // PNG of noisy (if the image has that layer), image and reference; empty: none
};

void describe(CLI::App&, CompareOptions&);

// Writes the table or the JSON object to `out`. Returns 0; throws InputError for files that cannot be read or
// written, have no R, G, B, or do not cover the same pixels.
int compare(const CompareOptions&, std::ostream& out);

// "N" or "WxH", 1 to kMaxEdge each.
std::optional<Size> parse_tile_size(std::string_view);

}  // namespace tessera
