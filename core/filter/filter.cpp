// SPDX-License-Identifier: Apache-2.0
#include "core/filter/filter.h"

#include <array>
#include <numeric>

namespace tessera {
namespace {

const std::array<FilterDescription, 1> kFilters{{
    {"none",
     "the noisy image as it is",
     "",
     channels_of(Aov::color),
     {},
     [](const ParameterValues&) { return std::vector<Pass>{}; }},
}};

}  // namespace

std::span<const FilterDescription> filters() { return kFilters; }

int halo(std::span<const Pass> passes) {
  return std::accumulate(passes.begin(), passes.end(), 0,
                         [](int sum, const Pass& p) { return sum + p.radius; });
}

const FilterDescription& FilterPlan::description() const {
  for (const FilterDescription& d : filters())
    if (d.name == name) return d;
  __builtin_unreachable();
}
std::vector<Pass> FilterPlan::passes() const { return description().passes(parameters); }
int FilterPlan::halo() const { return tessera::halo(passes()); }

}  // namespace tessera
