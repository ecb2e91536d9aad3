// SPDX-License-Identifier: Apache-2.0
#include "core/filter/broken_pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/layers.h"

namespace tessera {
namespace {

bool is_light(const Channel& c) {
  return c.statistic == Statistic::mean && (c.aov == Aov::color || c.aov == Aov::direct ||
                                            c.aov == Aov::indirect || c.aov == Aov::emission);
}

}  // namespace

std::vector<std::string> broken_planes(const FilterPlan& plan, const Image& input) {
  std::vector<std::string> found;
  const std::vector<Channel> channels = plan.inputs();
  const Region& r = input.region();
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const auto plane = input.plane(static_cast<int>(k));
    const auto bad = [](float v) { return !std::isfinite(v); };
    const auto count = std::ranges::count_if(plane, bad);
    if (count == 0) continue;
    const auto first = std::ranges::find_if(plane, bad) - plane.begin();
    found.push_back(fmt::format("{}: {} pixel{} not finite, the first at ({}, {})", file_channel(channels[k]),
                                count, count == 1 ? " is" : "s are", r.x0 + first % r.width(),
                                r.y0 + first / r.width()));
  }
  return found;
}

void break_whole_colors(const FilterPlan& plan, Image& input) {
  const std::vector<Channel> channels = plan.inputs();
  for (int k = 0; k + 2 < static_cast<int>(channels.size()); ++k) {
    const Channel& c = channels[static_cast<std::size_t>(k)];
    if (!is_light(c) || c.index != 0) continue;
    const auto r = input.plane(k), g = input.plane(k + 1), b = input.plane(k + 2);
    for (std::size_t i = 0; i < r.size(); ++i)
      if (!std::isfinite(r[i]) || !std::isfinite(g[i]) || !std::isfinite(b[i]))
        r[i] = g[i] = b[i] = std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace tessera
