// SPDX-License-Identifier: Apache-2.0
// Sizes as users write them.
#pragma once

#include <optional>
#include <string_view>

#include "core/region.h"

namespace tessera {

// "N" or "WxH", 1 to kMaxEdge each.
std::optional<Size> parse_tile_size(std::string_view);

// What --tile-size says. Throws Error(bad_usage).
Size tile_size_option(std::string_view text);

}  // namespace tessera
