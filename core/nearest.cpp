// SPDX-License-Identifier: Apache-2.0
#include "core/nearest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>
#include <vector>

namespace tessera {
namespace {

constexpr std::size_t kLongest = 64;  // letters looked at: a key may be megabytes of somebody's choosing

bool same(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

// Optimal string alignment distance: dynamic programming over the prefixes of both words.
std::size_t slips(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), now(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + !same(a[i - 1], b[j - 1])});
      if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
        now[j] = std::min(now[j], before[j - 2] + 1);
    }
    before = std::exchange(last, now);
    now.resize(b.size() + 1);
  }
  return last[b.size()];
}

}  // namespace

std::string_view nearest(std::string_view name, std::span<const std::string_view> known) {
  name = name.substr(0, kLongest);
  std::string_view best;
  std::size_t least = std::max<std::size_t>(name.size() / 2, 1) + 1;
  for (const std::string_view candidate : known) {
    const std::size_t d = slips(name, candidate.substr(0, kLongest));
    if (d >= least) continue;
    least = d;
    best = candidate;
  }
  return best;
}

std::string unknown(std::string_view what, std::string_view name, std::span<const std::string_view> known) {
  const std::string_view meant = nearest(name, known);
  return fmt::format("unknown {} '{}'{}", what, name.substr(0, kLongest),
                     meant.empty() ? "" : fmt::format("; did you mean '{}'?", meant));
}

std::string listed(std::span<const std::string_view> names) {
  constexpr std::size_t kShown = 12;
  std::string text;
  for (const std::string_view name : names.first(std::min(names.size(), kShown)))
    text += fmt::format("{}{}", text.empty() ? "" : ", ", name);
  if (names.size() > kShown) text += fmt::format(" and {} more", names.size() - kShown);
  return text;
}

}  // namespace tessera
