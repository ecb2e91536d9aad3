// SPDX-License-Identifier: Apache-2.0
#include "worker/render/mip_map.h"

#include <algorithm>
#include <array>
#include <bit>

namespace tessera::tracer {
namespace {

// What a texel of the next level takes from the texels 2i, 2i + 1 and 2i + 2 of an edge of `size`.
std::array<float, 3> shares(int i, int size) {
  if (size == 1) return {1, 0, 0};
  if (size % 2 == 0) return {0.5f, 0.5f, 0};
  const float n = static_cast<float>(size), half = static_cast<float>(size / 2), at = static_cast<float>(i);
  return {(half - at) / n, half / n, (at + 1) / n};
}

}  // namespace

Picture half_size(const Picture& p) {
  Picture half{p.name, std::max(1, p.width / 2), std::max(1, p.height / 2), p.channels, {}};
  const auto channels = static_cast<std::size_t>(p.channels), width = static_cast<std::size_t>(p.width);
  half.pixels.resize(static_cast<std::size_t>(half.width) * half.height * channels);
  std::vector<float> row(width * channels);  // of the next level's height, but of this one's width
  float* out = half.pixels.data();
  for (int y = 0; y < half.height; ++y) {
    const std::array<float, 3> down = shares(y, p.height);
    std::fill(row.begin(), row.end(), 0.0f);
    for (std::size_t k = 0; k < 3; ++k) {
      if (down[k] == 0) continue;
      const float* in = p.pixels.data() + (2 * static_cast<std::size_t>(y) + k) * row.size();
      for (std::size_t i = 0; i < row.size(); ++i) row[i] += down[k] * in[i];
    }
    for (int x = 0; x < half.width; ++x) {
      const std::array<float, 3> across = shares(x, p.width);
      for (std::size_t c = 0; c < channels; ++c, ++out) {
        *out = 0;
        for (std::size_t k = 0; k < 3; ++k)
          if (across[k] != 0) *out += across[k] * row[(2 * static_cast<std::size_t>(x) + k) * channels + c];
      }
    }
  }
  return half;
}

int mip_levels(const Picture& p) {
  return std::bit_width(static_cast<unsigned>(std::max(p.width, p.height)));
}

}  // namespace tessera::tracer
