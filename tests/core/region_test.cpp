// SPDX-License-Identifier: Apache-2.0
#include "core/region.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Region, TilesCoverEveryPixelOnceForOddSizesAndOffsets) {
  for (const Size size : {Size{1, 1}, Size{37, 53}, Size{64, 64}, Size{1000, 1000}})
    for (const Region area : {Region{0, 0, 97, 61}, Region{5, 7, 6, 8}, Region{63, 64, 130, 129}}) {
      std::vector<int> seen(area.area());
      for (const Tile& tile : tiles_over(area, size, 9)) {
        EXPECT_FALSE(tile.inner.empty());
        EXPECT_EQ(tile.outer, intersect(grown(tile.inner, 9), area));
        for (int y = tile.inner.y0; y < tile.inner.y1; ++y)
          for (int x = tile.inner.x0; x < tile.inner.x1; ++x)
            ++seen[(y - area.y0) * area.width() + x - area.x0];
      }
      EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), area.area());
    }
}

TEST(Region, CellsAreAlignedToTheGlobalGridAndNotToTheArea) {
  const auto cells = grid_cells({60, 10, 70, 20}, {64, 64});
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells[0], (Region{60, 10, 64, 20}));
  EXPECT_EQ(cells[1], (Region{64, 10, 70, 20}));
}

TEST(Region, AnEmptyAreaHasNoTiles) { EXPECT_TRUE(tiles_over({3, 3, 3, 9}, {8, 8}, 2).empty()); }

}  // namespace
}  // namespace tessera
