// SPDX-License-Identifier: Apache-2.0
// The randomness of a block's pixels.
#pragma once

#include "worker/render/sample_sums.h"
#include "worker/render/sampler.h"

namespace tessera::tracer {

struct BlockKeys {
  int x = 0, y = 0;  // the block's top left pixel
  std::array<std::array<std::uint64_t, kBlockPixels>, 2> half;

  BlockKeys(std::uint64_t seed, int frame, int x0, int y0) : x(x0), y(y0) {
    for (int h = 0; h < 2; ++h)
      for (int i = 0; i < kBlockPixels; ++i)
        half[static_cast<std::size_t>(h)][static_cast<std::size_t>(i)] =
            half_key(seed, frame, x0 + i % kBlockEdge, y0 + i / kBlockEdge, h);
  }
};

// Sets of random numbers: two for the camera, then four a vertex; others from the end of the range.
inline constexpr std::uint32_t kPixelSet = 0, kLensSet = 1;
inline std::uint32_t first_set(int vertex) { return 2 + 4 * static_cast<std::uint32_t>(vertex); }
inline constexpr std::uint32_t kTimeSet = 0xffff0000u, kCatcherSet = 0xffff0100u;

}  // namespace tessera::tracer
