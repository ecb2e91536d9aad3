// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/history.h"

#include <algorithm>
#include <cmath>

namespace tessera::reference {
namespace {

constexpr double kLongest = 128;

}  // namespace

std::vector<PastPixel> past_pixels(const Features& f, const Region& past, int x, int y,
                                   const std::function<bool(int, int)>& taken, bool wide) {
  // In single precision, as footprint() has it.
  const float qx = static_cast<float>(x) - static_cast<float>(f.at(Aov::motion, 0, x, y));
  const float qy = static_cast<float>(y) - static_cast<float>(f.at(Aov::motion, 1, x, y));
  const bool near = qx > past.x0 - 3 && qx < past.x1 + 3 && qy > past.y0 - 3 && qy < past.y1 + 3;
  if (past.empty() || !near) return {};
  const int left = static_cast<int>(std::floor(qx)), top = static_cast<int>(std::floor(qy));
  std::vector<PastPixel> pixels;
  double sum = 0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const double weight = (1 - std::abs(qx - (left + i))) * (1 - std::abs(qy - (top + j)));
      if (!past.contains(left + i, top + j) || !taken(left + i, top + j)) continue;
      pixels.push_back({left + i, top + j, weight});
      sum += weight;
    }
  if (sum < 0.01) {
    pixels.clear();
    if (!wide) return {};
    const int mid_x = static_cast<int>(std::floor(qx + 0.5)), mid_y = static_cast<int>(std::floor(qy + 0.5));
    for (int j = mid_y - 1; j <= mid_y + 1; ++j)
      for (int i = mid_x - 1; i <= mid_x + 1; ++i)
        if (past.contains(i, j) && taken(i, j)) pixels.push_back({i, j, 1});
  }
  return pixels;
}

double mean_of_plane(const std::vector<PastPixel>& pixels, const Image& past, int plane) {
  return mean(pixels, [&](int x, int y) { return double(past.at(plane, x, y)); });
}

bool same_surface(const Features& f, int x, int y, const Image& past, int first, int qx, int qy) {
  const double expected = f.at(Aov::previous_depth, 0, x, y);
  const double slope =
      std::abs(f.at(Aov::depth_gradient, 0, x, y)) + std::abs(f.at(Aov::depth_gradient, 1, x, y));
  const Rgb normal{past.at(first + 1, qx, qy), past.at(first + 2, qx, qy), past.at(first + 3, qx, qy)};
  const bool depth = std::abs(past.at(first, qx, qy) - expected) <= 2 * slope + 0.01 * std::abs(expected);
  const bool turned = !(squared(difference(normal, f.rgb(Aov::geometric_normal, x, y))) < 0.25);
  return depth && !turned && past.at(first + 4, qx, qy) == f.at(Aov::object_id, 0, x, y);
}

double plausible_length(float length) { return length >= 1 && length <= kLongest ? length : 0; }

double history_length(const Image& past, int plane, const std::vector<PastPixel>& pixels) {
  if (pixels.empty()) return 1;
  return std::min(std::nearbyint(mean_of_plane(pixels, past, plane)) + 1, kLongest);
}

double weight_of_now(const FilterPlan& plan, std::string_view alpha, double length) {
  if (length == 1) return 1;
  return plan.is("average", "plain") ? std::max(plan[alpha], 1 / length) : plan[alpha];
}

std::vector<double> trace(const Features& f, int x, int y) {
  const Rgb n = f.rgb(Aov::geometric_normal, x, y);
  return {f.at(Aov::depth, 0, x, y), n[0], n[1], n[2], f.at(Aov::object_id, 0, x, y)};
}

}  // namespace tessera::reference
