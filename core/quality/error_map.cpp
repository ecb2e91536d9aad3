// SPDX-License-Identifier: Apache-2.0
#include "core/quality/error_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace tessera {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

bool all_finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
}

bool any_nan(const std::vector<double>& values) {
  return std::ranges::any_of(values, [](double v) { return std::isnan(v); });
}

ErrorMap cropped(const ErrorMap& map, const Region& region) {
  assert(map.region.contains(region));
  ErrorMap part{region, {}};
  part.values.reserve(static_cast<std::size_t>(region.area()));
  for (int y = region.y0; y < region.y1; ++y) {
    const auto row = map.values.begin() +
                     (std::ptrdiff_t{y - map.region.y0} * map.region.width() + region.x0 - map.region.x0);
    part.values.insert(part.values.end(), row, row + region.width());
  }
  return part;
}

double worst_block_of(const ErrorMap& cell) {
  double worst = -std::numeric_limits<double>::infinity();
  for (const Region& block : grid_cells(cell.region, {8, 8})) {
    const double m = mean(cropped(cell, block));
    if (std::isnan(m)) return kNan;
    worst = std::max(worst, m);
  }
  return worst;
}

}  // namespace

double mean(const ErrorMap& map) { return mean_of(map.values); }

double trimmed_mean(const ErrorMap& map) {
  if (!all_finite(map.values)) return kNan;
  std::vector<double> values = map.values;
  const auto kept = values.end() - static_cast<std::ptrdiff_t>(values.size() / 1000);
  if (kept != values.end()) std::nth_element(values.begin(), kept, values.end());
  values.erase(kept, values.end());
  return mean_of(values);
}

double percentile(const ErrorMap& map, double share) {
  assert(share > 0 && share <= 1);
  if (map.values.empty() || any_nan(map.values)) return kNan;
  std::vector<double> values = map.values;
  const double below = std::ceil(share * static_cast<double>(values.size()));
  const auto at = values.begin() + (static_cast<std::ptrdiff_t>(std::max(below, 1.0)) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double weighted_median(const ErrorMap& map) {
  if (map.values.empty() || !all_finite(map.values)) return kNan;
  std::vector<double> values = map.values;
  std::ranges::sort(values);
  const double half = 0.5 * std::accumulate(values.begin(), values.end(), 0.0);
  double sum = 0;
  for (const double v : values)
    if ((sum += v) >= half) return v;
  return values.back();
}

double largest(const ErrorMap& map) {
  return map.values.empty() || any_nan(map.values) ? kNan : *std::ranges::max_element(map.values);
}

std::vector<CellErrors> by_cells(const ErrorMap& map, int edge) {
  std::vector<CellErrors> cells;
  for (const Region& region : grid_cells(map.region, {edge, edge})) {
    const ErrorMap cell = cropped(map, region);
    cells.push_back({region, mean(cell), percentile(cell, 0.99), worst_block_of(cell)});
  }
  return cells;
}

Image image_of(const ErrorMap& map) {
  Image image(map.region, 1);
  std::ranges::transform(map.values, image.plane(0).begin(), [](double e) { return static_cast<float>(e); });
  return image;
}

}  // namespace tessera
