// SPDX-License-Identifier: Apache-2.0
// How a region is parted into chunks for kernels/patches.cl, and what memory they take. Internal to
// worker/denoise.
#pragma once

#include <algorithm>

#include "worker/denoise/stage.h"

namespace tessera {

// As in the kernels.
inline constexpr int kChunkWidth = 64, kChunkRows = 32, kMapStride = kChunkWidth + 16, kMargin = 3,
                     kOffsets = 4;

class Chunks {
 public:
  // `own`: maps of a chunk's pixels that the greediest kernel takes beside the shared ones.
  Chunks(Stage& stage, int own)
      : rows_(std::min(kChunkRows, stage.outer().height())),
        scratch_(stage.scratch(static_cast<std::size_t>(of(stage, stage.outer())) * floats(own))) {}

  int rows() const { return rows_; }
  const Planes& scratch() const { return scratch_; }
  // One row of the range is a chunk of the region.
  Region over(const Stage& stage, const Region& region) const { return {0, 0, 1, of(stage, region)}; }

 private:
  int of(const Stage& stage, const Region& r) const {
    const int x0 = (r.x0 - stage.outer().x0) / stage.vector() * stage.vector();
    const int width = r.x1 - stage.outer().x0 - x0;
    return (width + kChunkWidth - 1) / kChunkWidth * ((r.height() + rows_ - 1) / rows_);
  }
  std::size_t floats(int own) const {
    const int high = rows_ + 2 * kMargin;
    return static_cast<std::size_t>(2 * kMapStride * high + 2 * kChunkWidth * high +
                                    own * kChunkWidth * rows_);
  }

  int rows_;
  Planes scratch_;
};

}  // namespace tessera
