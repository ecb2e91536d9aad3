// SPDX-License-Identifier: Apache-2.0
// What of each scale Ray Histogram Fusion needs for a tile. Regions count in a scale's own pixels: pixel i of
// scale s is the picture's 2^s i, whatever the tile.
#pragma once

#include <vector>

#include "core/filter/filter.h"
#include "core/region.h"

namespace tessera {

struct RhfPart {
  int level = 0;
  Region grid;      // of the frame; in the left and above it begins at or before the frame
  Region outer;     // what is held
  Region compared;  // pixels that are asked with whom they agree
  Region counted;   // pixels that are asked with how many they agree
  Region filtered;
  Region merged;  // what the next finer scale reads; of the finest, the tile
};

// From the finest on. `tile.outer` is what is held of it.
std::vector<RhfPart> rhf_parts(const FilterPlan&, const Tile& tile, const Region& frame);

}  // namespace tessera
