// SPDX-License-Identifier: Apache-2.0
// Where the blocks of Blockwise Multi-Order Feature Regression lie: a grid over the whole plane, whatever the
// frame or tile.
#pragma once

namespace tessera {

struct FilterPlan;

// Squares of `edge` pixels; the corner of one is at (x, y). Further grids lie half an edge away, so all of
// them are made of cells of half an edge.
struct BlockGrid {
  int edge = 0, x = 0, y = 0;
  int cell() const { return edge / 2; }
};

// Of a plan for `bmfr`.
BlockGrid block_grid(const FilterPlan&);

}  // namespace tessera
