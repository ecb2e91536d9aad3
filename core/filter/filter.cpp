// SPDX-License-Identifier: Apache-2.0
#include "core/filter/filter.h"

#include <array>
#include <cassert>
#include <numeric>

#include "core/filter/descriptions.h"

namespace tessera {

std::span<const FilterDescription> filters() {
  static const std::array all{describe_none(), describe_atrous(), describe_svgf()};
  return all;
}

void append_levels(std::vector<Pass>& passes, std::string_view kernel, int levels) {
  for (int i = 0; i < levels; ++i) passes.push_back({kernel, 1 << i, 2 << i});
}

Parameter levels_parameter(std::string_view source) {
  return {"levels", "levels of the a-trous transform; level i reads 2^(i+1) pixels far", "", source, 1, 5, 5,
          true};
}

int halo(std::span<const Pass> passes) {
  return std::accumulate(passes.begin(), passes.end(), 0,
                         [](int sum, const Pass& p) { return sum + p.radius; });
}

const FilterDescription& FilterPlan::description() const {
  for (const FilterDescription& d : filters())
    if (d.name == name) return d;
  assert(!"a plan is parsed or validated before it is used");
  __builtin_unreachable();
}
std::vector<Pass> FilterPlan::passes() const { return description().passes(parameters); }
int FilterPlan::halo() const { return tessera::halo(passes()); }

}  // namespace tessera
