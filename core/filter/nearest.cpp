// SPDX-License-Identifier: Apache-2.0
#include "core/filter/nearest.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace tessera {
namespace {

// Optimal string alignment distance: dynamic programming over the prefixes of both words.
std::size_t slips(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = std::min(now[j], before[j - 2] + 1);
    }
    before = std::exchange(last, now);
  }
  return last[b.size()];
}

}  // namespace

std::optional<std::string_view> nearest(std::string_view word, std::span<const std::string_view> names) {
  constexpr std::size_t kLongest = 64;  // a longer word is no slip of a name of ours
  std::optional<std::string_view> best;
  if (word.size() > kLongest) return best;
  std::size_t fewest = 0;
  for (const std::string_view name : names) {
    const std::size_t n = slips(word, name);
    const std::size_t allowed = std::max<std::size_t>(1, std::max(word.size(), name.size()) / 3);
    if (n <= allowed && (!best || n < fewest)) {
      best = name;
      fewest = n;
    }
  }
  return best;
}

}  // namespace tessera
