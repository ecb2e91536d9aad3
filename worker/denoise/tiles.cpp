// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/tiles.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr int kGroups = 16;  // work-groups: some for each core, so that none waits long for the last

int parts(int length, int most) { return (length + most - 1) / most; }
int even(int length, int most) { return parts(length, parts(length, most)); }

}  // namespace

Tiles tiles(const Stage& s, const Region& over, int columns, int rows) {
  const int vector = s.vector();
  // The kernel starts at a multiple of the vector.
  const int wide = over.width() + (over.x0 - s.outer().x0) % vector;
  Tiles t{.columns = rounded_up(even(wide, columns), vector), .rows = even(over.height(), rows)};
  t.groups = std::min(kGroups, parts(wide, t.columns) * parts(over.height(), t.rows));
  return t;
}

}  // namespace tessera
