// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/svgf.h"

#include <algorithm>
#include <cmath>

#include "tests/reference/surface.h"

namespace tessera::reference {
namespace {

// Direct or indirect illumination, and the variance of its luminance.
struct Light {
  std::vector<Rgb> color;
  std::vector<double> variance;
};

class Svgf {
 public:
  Svgf(const FilterPlan& plan, const Image& input) : plan_(plan), f_(plan, input) {}

  const Features& features() const { return f_; }

  Light light(Aov aov) const {
    Light l{std::vector<Rgb>(area()), std::vector<double>(area())};
    each_valid(f_, [&](int x, int y) {
      const Rgb c = f_.rgb(aov, x, y), albedo = floored(f_.rgb(Aov::albedo, x, y));
      const Rgb v = f_.rgb(aov, x, y, Statistic::variance_of_mean);
      Rgb deviation{};
      for (int k = 0; k < 3; ++k) {
        l.color[f_.index(x, y)][k] = c[k] / albedo[k];
        deviation[k] = std::sqrt(v[k]) / albedo[k];
      }
      l.variance[f_.index(x, y)] = std::pow(luminance(deviation), 2);
    });
    return l;
  }

  // 7x7 window with the geometry's weights: the picture's variance, or the mean of the samples' ones.
  void estimate_variance(Light& l) const {
    std::vector<double> estimate(area());
    each_valid(f_, [&](int x, int y) {
      double sum = 0, first = 0, second = 0, mean = 0;
      const double centre = luminance(l.color[f_.index(x, y)]);
      each_tap(f_, x, y, 3, 1, [&](int, int, int qx, int qy) {
        const double w = geometry(x, y, qx, qy);
        const double d = std::clamp(luminance(l.color[f_.index(qx, qy)]) - centre, -1e18, 1e18);
        sum += w;
        first += w * d;
        second += w * d * d;
        mean += w * std::min(l.variance[f_.index(qx, qy)], 1e36);
      });
      const bool spatial = plan_["variance"] == 0;
      estimate[f_.index(x, y)] =
          spatial ? std::max(0.0, second / sum - std::pow(first / sum, 2)) : mean / sum;
    });
    l.variance = estimate;
  }

  void level(Light& l, int step) const {
    Light next = l;
    each_valid(f_, [&](int x, int y) {
      const std::size_t p = f_.index(x, y);
      const double deviation = plan_["sigma_l"] * std::sqrt(smoothed(f_, l.variance, x, y)) + 1e-10;
      double sum = 0, variance = 0;
      Rgb total{};
      each_tap(f_, x, y, 2, step, [&](int i, int j, int qx, int qy) {
        const std::size_t q = f_.index(qx, qy);
        const double dl = std::abs(luminance(l.color[q]) - luminance(l.color[p]));
        const bool self = i == 0 && j == 0;
        const double w = b3(i) * b3(j) * (self ? 1 : geometry(x, y, qx, qy) * std::exp(-dl / deviation));
        sum += w;
        variance += w * w * l.variance[q];
        for (int k = 0; k < 3; ++k) total[k] += w * l.color[q][k];
      });
      for (int k = 0; k < 3; ++k) next.color[p][k] = total[k] / sum;
      next.variance[p] = variance / (sum * sum);
    });
    l = next;
  }

 private:
  std::size_t area() const { return static_cast<std::size_t>(f_.region().area()); }

  // w_z w_n; 1 for p itself.
  double geometry(int x, int y, int qx, int qy) const {
    if (x == qx && y == qy) return 1;
    const Rgb n = f_.unit_normal(x, y), m = f_.unit_normal(qx, qy);
    const double cosine = std::clamp(n[0] * m[0] + n[1] * m[1] + n[2] * m[2], 0.0, 1.0);
    return std::exp(-depth_exponent(f_, x, y, qx, qy, plan_["sigma_z"])) *
           std::pow(cosine, std::pow(2, plan_["sigma_n"]));
  }

  const FilterPlan& plan_;
  Features f_;
};

}  // namespace

Image svgf(const FilterPlan& plan, const Image& input) {
  const Svgf svgf(plan, input);
  const Features& f = svgf.features();
  Light direct = svgf.light(Aov::direct), indirect = svgf.light(Aov::indirect);
  for (Light* l : {&direct, &indirect}) {
    svgf.estimate_variance(*l);
    for (const Pass& pass : plan.passes())
      if (pass.kernel == "svgf_level") svgf.level(*l, pass.step);
  }
  const Region& r = input.region();
  Image out(r, 3);
  for (int k = 0; k < 3; ++k)
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) {
        const std::size_t p = f.index(x, y);
        const double emission = f.at(Aov::emission, k, x, y);
        const double noisy = f.at(Aov::direct, k, x, y) + f.at(Aov::indirect, k, x, y) + emission;
        const double lit = (direct.color[p][k] + indirect.color[p][k]) * floored(f.rgb(Aov::albedo, x, y))[k];
        out.at(k, x, y) = static_cast<float>(f.valid(x, y)          ? lit + emission
                                             : std::isfinite(noisy) ? noisy
                                                                    : 0.0);
      }
  return out;
}

}  // namespace tessera::reference
