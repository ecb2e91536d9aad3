// SPDX-License-Identifier: Apache-2.0
#include "core/ranks.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace tessera {

RankList merged(const RankList& a, const RankList& b) {
  std::array<Rank, 2 * kMatteRanks> all;
  std::size_t n = 0;
  const auto end = [](const RankList& list) {
    return std::find_if(list.begin(), list.end(), [](const Rank& r) { return !(r.samples > 0); });
  };
  for (auto r = a.begin(); r != end(a); ++r) all[n++] = *r;
  for (auto r = b.begin(); r != end(b); ++r) {
    const auto same =
        std::find_if(all.begin(), all.begin() + n, [&](const Rank& x) { return x.id == r->id; });
    if (same != all.begin() + n)
      same->samples += r->samples;
    else
      all[n++] = *r;
  }
  std::sort(all.begin(), all.begin() + n, [](const Rank& x, const Rank& y) {
    if (x.samples != y.samples) return x.samples > y.samples;
    return std::bit_cast<std::uint32_t>(x.id) < std::bit_cast<std::uint32_t>(y.id);
  });
  RankList kept;
  std::copy_n(all.begin(), std::min(n, kept.size()), kept.begin());
  return kept;
}

RankList load_ranks(const float* at, std::size_t stride) {
  RankList list;
  for (std::size_t k = 0; k < list.size(); ++k) list[k] = {at[2 * k * stride], at[(2 * k + 1) * stride]};
  return list;
}

void store_ranks(const RankList& list, float* at, std::size_t stride) {
  for (std::size_t k = 0; k < list.size(); ++k) {
    at[2 * k * stride] = list[k].id;
    at[(2 * k + 1) * stride] = list[k].samples;
  }
}

}  // namespace tessera
