// SPDX-License-Identifier: Apache-2.0
// The scales at which `rhf` looks at a picture.
#pragma once

#include "tests/reference/features.h"

namespace tessera::reference {

struct RhfPixel {
  static constexpr int bins = 3 * kHistogramBins;

  bool valid = false;
  double samples = 0;
  Rgb color{}, albedo{}, normal{};
  std::array<double, bins> counts{};
};

// Its pixel i lies on pixel 2^level i of the picture.
struct RhfPicture {
  int level = 0;
  Region region;
  std::vector<RhfPixel> pixels;

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - region.y0) * region.width() + (x - region.x0);
  }
  const RhfPixel& at(int x, int y) const { return pixels[index(x, y)]; }
  // It is a neighbour of others.
  bool counts(int x, int y) const { return region.contains(x, y) && at(x, y).valid && at(x, y).samples > 0; }
};

RhfPicture finest_scale(const FilterPlan&, const Image& input);
RhfPicture coarser_scale(const RhfPicture& finest, int level);
// R_s = F_s + U(R_{s+1}) - U(D(F_s)): `merged` is R_{s+1}, of `coarse`.
std::vector<Rgb> merged_into(const RhfPicture& fine, const std::vector<Rgb>& filtered,
                             const RhfPicture& coarse, const std::vector<Rgb>& merged);

}  // namespace tessera::reference
