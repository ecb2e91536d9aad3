// SPDX-License-Identifier: Apache-2.0
// Lists of the ids that cover a pixel, most frequent first, as Cryptomatte wants them (Friedman and Jones
// 2015, "Fully Automatic ID Mattes with Support for Motion Blur and Transparency"). Lists are merged at the
// nodes of the sample tree, whose shape is fixed: so what is cut off when there are more than kMatteRanks ids
// is fixed too.
#pragma once

#include <array>
#include <cstddef>

#include "core/aov.h"

namespace tessera {

struct Rank {
  float id = 0;       // Cryptomatte's hash as a float; never 0 if there is a weight
  float samples = 0;  // how many; 0: the list ends here
  bool operator==(const Rank&) const = default;
};
using RankList = std::array<Rank, kMatteRanks>;

// The weights of equal ids added; the heaviest kept, of equally heavy ones those of smaller ids.
RankList merged(const RankList& a, const RankList& b);

// Lists in planes: entry k of a pixel's list is id at[2 * k * stride] and samples at[(2 * k + 1) * stride].
RankList load_ranks(const float* at, std::size_t stride);
void store_ranks(const RankList&, float* at, std::size_t stride);

}  // namespace tessera
