// SPDX-License-Identifier: Apache-2.0
// What stands in for layers that files do not have, and what becomes of broken ones.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/image.h"

namespace tessera {

// The variance of each pixel's noise, from the picture alone: the squared response of the 3x3 difference of
// two Laplacians (which is blind to planes; J. Immerkaer: Fast Noise Variance Estimation, CVIU 1996),
// averaged over 7x7. Detail counts as noise. One plane for each of `picture`.
Image estimated_variance(const Image& picture);

// The change of depth per pixel to the right and down, planes x and y, of a plane of depths: the smaller one
// of the differences to both sides, since the larger one may lead over an edge. 0 beside the sky and on it.
Image depth_differences(const Image& depth);

// Depths of 1e10 and more (what Cycles writes where there is nothing), or that are not finite, become
// kSkyDepth.
void mark_sky(std::span<float> depth);

// Motion that is not finite, or is farther than any frame is wide, leads nowhere from now on: outside of any
// frame. Returns how many pixels were broken, of which kSkyDepth, which says the same, is none, and the
// first.
struct BrokenPixels {
  std::int64_t count = 0;
  std::size_t first = 0;
};
BrokenPixels mend_motion(std::array<std::span<float>, 2> motion);

}  // namespace tessera
