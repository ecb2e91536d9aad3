// SPDX-License-Identifier: Apache-2.0
#include "core/sample_range.h"

#include <algorithm>
#include <bit>

namespace tessera {

bool is_dyadic(const SampleRange& r) {
  const int n = r.count();
  return r.begin >= 0 && n >= kLeafSamples && std::has_single_bit(static_cast<unsigned>(n)) &&
         r.begin % n == 0;
}

SampleRange sibling(const SampleRange& r) {
  const int n = r.count();
  return (r.begin / n) % 2 == 0 ? SampleRange{r.end, r.end + n} : SampleRange{r.begin - n, r.begin};
}

bool are_siblings(const SampleRange& a, const SampleRange& b) {
  return is_dyadic(a) && a.end == b.begin && sibling(a) == b;
}

std::vector<SampleRange> dyadic_blocks(const SampleRange& range, int most) {
  int length = kLeafSamples;
  while (length * 2 <= std::min(most, range.count())) length *= 2;
  std::vector<SampleRange> blocks;
  for (int s = range.begin; s < range.end; s += length) blocks.push_back({s, s + length});
  return blocks;
}

}  // namespace tessera
