// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/fdf.h"

#include <algorithm>
#include <cmath>

#include "tests/reference/features.h"
#include "tests/reference/nlm.h"

namespace tessera::reference {
namespace {

// A channel after v -> scale v + shift, with the variance of the mean of a population.
Signal signal_of(const Features& f, Aov a, int c, double scale, double shift) {
  Signal s;
  const Region& r = f.region();
  const bool varies = f.has(a, Statistic::variance_of_mean);
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      const double n = f.samples(x, y);
      const double v = varies && n > 1 ? f.at(a, c, x, y, Statistic::variance_of_mean) * (n - 1) / n : 0;
      s.value.push_back(scale * f.at(a, c, x, y) + shift);
      s.variance.push_back(scale * scale * v);
    }
  return s;
}

double largest_difference(const std::vector<std::vector<double>>& feature, std::size_t p, std::size_t q) {
  double most = 0;
  for (const auto& channel : feature) most = std::max(most, std::abs(channel[p] - channel[q]));
  return most;
}

}  // namespace

Image fdf(const FilterPlan& unresolved, const Image& input) {
  const FilterPlan plan = resolved(unresolved, {});
  const Features f(plan, input);
  const Region& r = input.region();
  const NlmWindow window{r, static_cast<int>(plan["prefilter_radius"]),
                         static_cast<int>(plan["prefilter_patch"]),
                         [&](int x, int y) { return f.valid(x, y); }};
  const auto smoothed = [&](const Signal& s) { return nlm_mean_of_exp(window, s, plan["epsilon"]); };
  std::vector<std::vector<double>> t(3), n(3);
  for (int c = 0; c < 3; ++c) {
    const Signal albedo = signal_of(f, Aov::albedo, c, 1, 0), normal = signal_of(f, Aov::normal, c, 0.5, 0.5);
    const bool raw = plan.is("guides", "raw");
    t[c] = raw ? albedo.value : smoothed(albedo);
    n[c] = raw ? normal.value : smoothed(normal);
  }
  const std::vector<std::vector<double>> s{smoothed(signal_of(f, Aov::shading, 0, 1 / plan["light"], 0))};
  const int radius = static_cast<int>(plan["radius"]);
  Image out(r, 3);
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      double sum = 0;
      Rgb total{};
      const std::size_t p = f.index(x, y);
      for (int qy = y - radius; f.valid(x, y) && qy <= y + radius; ++qy)
        for (int qx = x - radius; qx <= x + radius; ++qx) {
          if (!f.valid(qx, qy)) continue;
          const std::size_t q = f.index(qx, qy);
          const double samples = std::sqrt(f.samples(x, y) * f.samples(qx, qy));
          const double w = std::exp(-std::max({largest_difference(t, p, q) / plan["t_max"],
                                               largest_difference(n, p, q) / plan["n_max"],
                                               largest_difference(s, p, q) * samples / plan["s_max"]}));
          sum += w;
          for (int k = 0; k < 3; ++k) total[k] += w * f.at(Aov::color, k, qx, qy);
        }
      for (int k = 0; k < 3; ++k) {
        const double color = f.at(Aov::color, k, x, y);
        out.at(k, x, y) = static_cast<float>(f.valid(x, y)          ? total[k] / sum
                                             : std::isfinite(color) ? color
                                                                    : 0.0);
      }
    }
  return out;
}

}  // namespace tessera::reference
