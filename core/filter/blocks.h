// SPDX-License-Identifier: Apache-2.0
// What Blockwise Multi-Order Feature Regression fits, and to what: blocks of a grid over the whole plane,
// whatever the frame or tile; columns made of features.
#pragma once

#include "core/filter/filter.h"

namespace tessera {

// Squares of `edge` pixels; the corner of one is at (x, y). Further grids lie half an edge away, so all of
// them are made of cells of half an edge.
struct BlockGrid {
  int edge = 0, x = 0, y = 0;
  int cell() const { return edge / 2; }
};

// Of a plan for `bmfr`.
BlockGrid block_grid(const FilterPlan&);
int grids_taken(const ParameterValues&);

// The columns beside the constant.
struct BlockFeatures {
  int normals = 1, positions = 2;  // 0: not taken   1: as they are   2: and their squares
  int gradients = 0;               // the place in the block, from -1 to 1 across and down
  int material = 0;                // the number of the material
  int columns() const { return 3 * normals + 3 * positions + 2 * gradients + material; }
  // What is scaled to -1 .. 1 within each block.
  int axes() const { return (positions > 0 ? 3 : 0) + material; }
};
BlockFeatures block_features(const ParameterValues&);

// Floats of what is known of a cell, and of a model that is fitted to four of them.
struct BlockSizes {
  int features = 0, axes = 0;  // as BlockFeatures says
  int columns = 0;             // of the fit: 1, features, noise on them
  int roles = 1;               // in which a cell is summed up
  int sums() const { return columns * (columns + 1) / 2 + 3 * columns; }
  int of_cell() const { return roles * sums() + 3 * axes + 6; }
  int of_model() const { return 3 + 3 * features + 3 * axes + 3; }
};
BlockSizes block_sizes(const ParameterValues&);

// Planes that accumulation over frames leaves: light, of how many frames, and filtered light.
inline constexpr int kAccumulatedPlanes = 3 + 1 + 3;

// Whether a pixel before may be of this surface though it is elsewhere in the world: told by depth and
// object.
bool surfaces_move(const ParameterValues&);

}  // namespace tessera
