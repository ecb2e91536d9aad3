// SPDX-License-Identifier: Apache-2.0
#include "core/quality/seam.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

// One of the two directions in which tiles have borders: across columns or across rows.
struct Lines {
  double border_sum = 0, between_sum = 0;
  std::int64_t borders = 0, betweens = 0;
};

int modulo(int v, int m) { return ((v % m) + m) % m; }

// `along` steps from pixel to pixel across the lines: {1, 0} for vertical lines.
Lines jumps(const Image& x, const Image& r, int edge, Size along) {
  const Region area = x.region();
  Lines lines;
  for (int py = area.y0 + along.height; py < area.y1; ++py)
    for (int px = area.x0 + along.width; px < area.x1; ++px) {
      const int at = modulo(along.width ? px : py, edge);
      const bool border = at == 0, between = at == edge / 2 && !border;
      if (!border && !between) continue;
      double jump = 0;
      for (int c = 0; c < 3; ++c) {
        const int qx = px - along.width, qy = py - along.height;
        jump += std::abs((double(x.at(c, px, py)) - r.at(c, px, py)) -
                         (double(x.at(c, qx, qy)) - r.at(c, qx, qy)));
      }
      (border ? lines.border_sum : lines.between_sum) += jump;
      ++(border ? lines.borders : lines.betweens);
    }
  return lines;
}

}  // namespace

double seam(const Image& x, const Image& r, Size tile) {
  assert(x.region() == r.region() && x.planes() >= 3 && r.planes() >= 3);
  assert(tile.width > 0 && tile.height > 0);
  double at_borders = 0, between = 0;
  bool any = false;
  for (const Lines& lines : {jumps(x, r, tile.width, {1, 0}), jumps(x, r, tile.height, {0, 1})}) {
    if (lines.borders == 0 || lines.betweens == 0) continue;
    any = true;
    at_borders += lines.border_sum / static_cast<double>(lines.borders);
    between += lines.between_sum / static_cast<double>(lines.betweens);
  }
  if (!any) return std::numeric_limits<double>::quiet_NaN();
  if (at_borders == 0 && between == 0) return 1.0;
  return at_borders / between;
}

}  // namespace tessera
