// SPDX-License-Identifier: Apache-2.0
#include "core/scene/nearest.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace tessera {
namespace {

constexpr std::size_t kLongest = 64;  // letters looked at: a key may be megabytes of somebody's choosing

std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string_view nearest(std::string_view name, std::span<const std::string_view> known) {
  name = name.substr(0, kLongest);
  std::string_view best;
  std::size_t least = std::max<std::size_t>(name.size() / 2, 1) + 1;
  for (const std::string_view candidate : known) {
    const std::size_t d = distance(name, candidate.substr(0, kLongest));
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
