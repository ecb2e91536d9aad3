// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/atrous.h"

#include <algorithm>
#include <cmath>

#include "core/filter/descriptions.h"
#include "tests/reference/history.h"
#include "tests/reference/surface.h"

namespace tessera::reference {
namespace {

using Plane = std::vector<Rgb>;

Plane level(const FilterPlan& plan, const Features& f, const Plane& from, int step) {
  const auto square = [](double v) { return v * v; };
  const double color2 = square(plan["sigma_c"] / step), normal2 = square(plan["sigma_n"] * step),
               position2 = square(plan["sigma_x"] * step);
  Plane to = from;
  const Region& r = f.region();
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      if (!f.valid(x, y)) continue;
      const Rgb& c = from[f.index(x, y)];
      const double footprint2 = squared_footprint(f, x, y);
      double sum = 0;
      Rgb total{};
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) {
          const int qx = x + i * step, qy = y + j * step;
          if (!f.valid(qx, qy)) continue;
          const Rgb& cq = from[f.index(qx, qy)];
          const double distance2 =
              squared(difference(f.rgb(Aov::position, qx, qy), f.rgb(Aov::position, x, y)));
          double exponent = squared(difference(cq, c)) / color2;
          exponent += squared_turn(f, x, y, qx, qy) / normal2;
          if (distance2 > 0) exponent += distance2 / (position2 * (footprint2 + 1e-30));
          const double w = b3(i) * b3(j) * std::exp(-exponent);
          sum += w;
          for (int k = 0; k < 3; ++k) total[k] += w * cq[k];
        }
      for (int k = 0; k < 3; ++k) to[f.index(x, y)][k] = total[k] / sum;
    }
  return to;
}

constexpr int kLength = 3;  // plane of the history

void accumulate(const FilterPlan& plan, const Features& f, Plane& light, const Image& history, Image& out) {
  each_valid(f, [&](int x, int y) {
    const auto pixels = past_pixels(f, history.region(), x, y, [&](int qx, int qy) {
      bool fit = plausible_length(history.at(kLength, qx, qy)) > 0;
      for (int k = 0; k < 3; ++k) fit &= std::abs(history.at(k, qx, qy)) <= 1e32f;
      return fit && same_surface(f, x, y, history, kLength + 1, qx, qy);
    });
    const double length = history_length(history, kLength, pixels), a = weight_of_now(plan, "alpha", length);
    Rgb& now = light[f.index(x, y)];
    for (int k = 0; k < 3; ++k) {
      now[k] = a * now[k] + (1 - a) * mean_of_plane(pixels, history, k);
      out.at(3 + k, x, y) = static_cast<float>(now[k]);
    }
    out.at(3 + kLength, x, y) = static_cast<float>(length);
    const std::vector<double> shown = trace(f, x, y);
    for (int k = 0; k < 5; ++k) out.at(3 + kLength + 1 + k, x, y) = static_cast<float>(shown[k]);
  });
}

}  // namespace

Image atrous(const FilterPlan& plan, const Image& input, const Image& history) {
  const Features f(plan, input);
  const Region& r = input.region();
  Plane light(static_cast<std::size_t>(r.area()));
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      if (!f.valid(x, y)) continue;
      const Rgb lit = difference(f.rgb(Aov::color, x, y), f.rgb(Aov::emission, x, y));
      const Rgb albedo = floored(f.rgb(Aov::albedo, x, y));
      light[f.index(x, y)] = {lit[0] / albedo[0], lit[1] / albedo[1], lit[2] / albedo[2]};
    }
  Image out(r, 3 + plan.history());
  if (with_history(plan.parameters)) accumulate(plan, f, light, history, out);
  for (const Pass& pass : plan.passes())
    if (pass.kernel == "atrous_level") light = level(plan, f, light, pass.step);
  for (int k = 0; k < 3; ++k)
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) {
        const double color = f.at(Aov::color, k, x, y);
        const double lit = light[f.index(x, y)][k] * floored(f.rgb(Aov::albedo, x, y))[k];
        out.at(k, x, y) = static_cast<float>(f.valid(x, y)          ? lit + f.at(Aov::emission, k, x, y)
                                             : std::isfinite(color) ? color
                                                                    : 0.0);
      }
  return out;
}

}  // namespace tessera::reference
