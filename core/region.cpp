// SPDX-License-Identifier: Apache-2.0
#include "core/region.h"

namespace tessera {

std::vector<Region> grid_cells(const Region& area, Size edge) {
  std::vector<Region> cells;
  if (area.empty()) return cells;
  const auto floor_to = [](int v, int step) { return v - ((v % step) + step) % step; };
  for (int y = floor_to(area.y0, edge.height); y < area.y1; y += edge.height)
    for (int x = floor_to(area.x0, edge.width); x < area.x1; x += edge.width)
      cells.push_back(intersect({x, y, x + edge.width, y + edge.height}, area));
  return cells;
}

std::vector<Tile> tiles_over(const Region& area, Size size, int halo) {
  std::vector<Tile> tiles;
  for (const Region& inner : grid_cells(area, size))
    tiles.push_back({inner, intersect(grown(inner, halo), area)});
  return tiles;
}

}  // namespace tessera
