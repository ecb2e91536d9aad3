// SPDX-License-Identifier: Apache-2.0
// Windows whose weights are the same both ways (worker/denoise/kernels/pairs.cl): what a tile of them keeps.
#pragma once

namespace tessera {

// Tiles in which the kernel works, and the offsets it takes at a time.
inline constexpr int kPairColumns = 128, kPairRows = 64, kPairGroup = 9;

struct PairShape {
  int radius = 0;  // of the window

  // Of weights that are kept: a power of two. A row is gathered with the one `radius` rows before it, while
  // other work-items are a row ahead.
  constexpr int rows() const {
    int rows = 2;
    while (rows < radius + 2) rows *= 2;
    return rows;
  }
};

// Of one tile, by vectors: sums and sums of colour of its pixels, rows of weights.
constexpr int pair_floats(const PairShape& s, int columns, int rows, int vector) {
  return 4 * columns * rows + s.rows() * kPairGroup * (columns + s.radius + kPairGroup + vector);
}

}  // namespace tessera
