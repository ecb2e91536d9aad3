// SPDX-License-Identifier: Apache-2.0
// Tiles of a region for work-groups that need memory of their own (kernels/tiles.cl). Internal to
// worker/denoise.
#pragma once

#include "worker/denoise/stage.h"

namespace tessera {

struct Tiles {
  int columns = 0, rows = 0, groups = 0;  // columns: whole vectors
};

// Of nearly one size, at most so large, for kernels to which `over` is passed.
Tiles tiles(const Stage&, const Region& over, int columns, int rows);

}  // namespace tessera
