// SPDX-License-Identifier: Apache-2.0
// Rectangles of pixels in the global grid of a frame, and how a frame is cut into tiles and cells.
#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <vector>

namespace tessera {

// Half-open rectangle of pixels: x in [x0, x1), y in [y0, y1). Pixel (0, 0) is the frame's top left corner.
struct Region {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
  std::int64_t area() const { return empty() ? 0 : std::int64_t(width()) * height(); }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  bool contains(const Region& r) const {
    return r.empty() || (r.x0 >= x0 && r.x1 <= x1 && r.y0 >= y0 && r.y1 <= y1);
  }
  auto operator<=>(const Region&) const = default;
};

inline Region intersect(const Region& a, const Region& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}
inline Region grown(const Region& r, int by) { return {r.x0 - by, r.y0 - by, r.x1 + by, r.y1 + by}; }

// `inner` is owned and never overlaps another tile's; `outer` is inner grown by the halo, cut to the frame.
struct Tile {
  Region inner, outer;
  auto operator<=>(const Tile&) const = default;
};

struct Size {
  int width = 0, height = 0;
  auto operator<=>(const Size&) const = default;
};

// The parts of `area` in each square of `edge` pixels of the global grid, left to right, top to bottom.
std::vector<Region> grid_cells(const Region& area, Size edge);

// Tiles of `size` pixels over `area`, with a halo cut to `area`. The inner regions cover `area` exactly once.
std::vector<Tile> tiles_over(const Region& area, Size size, int halo);

// The unit of decision: aligned squares of the global grid, whatever the tiles.
inline constexpr int kCellEdge = 64;

}  // namespace tessera
