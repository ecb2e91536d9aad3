// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/sure_atrous.h"

#include <algorithm>
#include <cmath>

#include "tests/reference/surface.h"

namespace tessera::reference {
namespace {

constexpr double kMostVariance = 1e36;

// A level's input: colour, the sum of its channels' variances, the variance of its luminance.
struct Coarse {
  std::vector<Rgb> color;
  std::vector<double> noise, luminance;
};

// What a level took out, and the variance of the noise in it, summed over the channels.
struct Detail {
  std::vector<Rgb> difference;
  std::vector<double> noise;
};

class SureAtrous {
 public:
  SureAtrous(const FilterPlan& plan, const Image& input) : plan_(plan), f_(plan, input) {}

  const Features& features() const { return f_; }

  Coarse finest() const {
    Coarse c{std::vector<Rgb>(area()), std::vector<double>(area()), std::vector<double>(area())};
    const bool spatial = plan_.is("variance", "spatial");
    each_valid(f_, [&](int x, int y) {
      const std::size_t p = f_.index(x, y);
      c.color[p] = f_.rgb(Aov::color, x, y);
      if (spatial) return;
      const Rgb v = f_.rgb(Aov::color, x, y, Statistic::variance_of_mean);
      c.noise[p] = std::min(v[0] + v[1] + v[2], kMostVariance);
      c.luminance[p] = std::min(std::pow(luminance({std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2])}), 2),
                                kMostVariance);
    });
    if (spatial) find_variance(c);
    return c;
  }

  Coarse coarser(const Coarse& c, const Coarse& finest, int level, Detail& detail) const {
    Coarse next = c;
    each_valid(f_, [&](int x, int y) {
      const std::size_t p = f_.index(x, y);
      const double stop = light_scale(c, finest, level, x, y);
      double sum = 0, noise = 0, light = 0, others = 0;
      Rgb total{};
      each_tap(f_, x, y, 2, 1 << level, [&](int i, int j, int qx, int qy) {
        const std::size_t q = f_.index(qx, qy);
        const double apart = light_distance(c.color[p], c.color[q]) / stop + surface(x, y, qx, qy, level);
        const double w = b3(i) * b3(j) * std::exp(-apart);
        sum += w;
        if (p != q) others += w;
        if (p != q) noise += w * w * c.noise[q];
        light += w * w * c.luminance[q];
        for (int k = 0; k < 3; ++k) total[k] += w * c.color[q][k];
      });
      for (int k = 0; k < 3; ++k) next.color[p][k] = total[k] / sum;
      next.noise[p] = (noise + std::pow(sum - others, 2) * c.noise[p]) / (sum * sum);
      next.luminance[p] = light / (sum * sum);
      detail.difference[p] = difference(c.color[p], next.color[p]);
      // Sum of (delta_pq - w_pq / sum)^2 V(q).
      detail.noise[p] = correction(level) * (noise + others * others * c.noise[p]) / (sum * sum);
    });
    return next;
  }

  // Of the details of a level at p.
  double weight(const Detail& d, int level, int x, int y) const {
    if (plan_.is("mode", "literal")) return printed_weight(d.difference[f_.index(x, y)]);
    double squares = 0, noise = 0;
    each_tap(f_, x, y, static_cast<int>(plan_["window"]), 1 << level, [&](int, int, int qx, int qy) {
      squares += squared(d.difference[f_.index(qx, qy)]);
      noise += d.noise[f_.index(qx, qy)];
    });
    if (plan_.is("weights", "continuous")) return squares > noise ? 1 - noise / squares : 0;
    const auto risk = [&](double w) { return (w - 1) * (w - 1) * squares + (2 * w - 1) * noise; };
    return best({0, 0.2, 0.4, 0.6, 0.8, 1}, risk);
  }

  Detail no_detail() const { return {std::vector<Rgb>(area()), std::vector<double>(area())}; }

 private:
  std::size_t area() const { return static_cast<std::size_t>(f_.region().area()); }

  template <typename Risk>
  static double best(std::initializer_list<double> candidates, const Risk& risk) {
    return *std::ranges::min_element(candidates, {}, risk);
  }

  // Equation 2 as printed, with f(d) = w d, over the channels; N_c = 4 candidates.
  static double printed_weight(const Rgb& d) {
    return best({0.2, 0.4, 0.6, 0.8}, [&](double w) {
      double risk = 4;
      for (const double v : d) {
        if (std::abs(v) <= w * v) risk -= 2;
        risk += std::pow(std::min(std::abs(v), w * v), 2);
      }
      return risk;
    });
  }

  double light_distance(const Rgb& a, const Rgb& b) const {
    return plan_.is("edge", "svgf") ? std::abs(luminance(difference(a, b))) : squared(difference(a, b));
  }

  double light_scale(const Coarse& c, const Coarse& finest, int level, int x, int y) const {
    if (plan_.is("edge", "svgf"))
      return plan_["sigma_l"] * std::sqrt(smoothed(f_, c.luminance, x, y)) + 1e-10;
    return std::pow(plan_["sigma_y"], 2) * (finest.noise[f_.index(x, y)] + 1e-20) * std::pow(0.25, level);
  }

  // -ln of w_n w_x.
  double surface(int x, int y, int qx, int qy, int level) const {
    const double step = 1 << level;
    double apart = squared_turn(f_, x, y, qx, qy) / std::pow(plan_["sigma_n"] * step, 2);
    if (plan_.is("distance", "depth")) return apart + depth_exponent(f_, x, y, qx, qy, plan_["sigma_z"]);
    const double distance = squared(difference(f_.rgb(Aov::position, qx, qy), f_.rgb(Aov::position, x, y)));
    return apart + distance / (std::pow(plan_["sigma_x"] * step, 2) * (squared_footprint(f_, x, y) + 1e-30));
  }

  // The variance of the 7x7 picture around, on the surface around.
  void find_variance(Coarse& c) const {
    each_valid(f_, [&](int x, int y) {
      const std::size_t p = f_.index(x, y);
      double sum = 0, squares = 0, light = 0;
      Rgb mean{};
      each_tap(f_, x, y, 3, 1, [&](int, int, int qx, int qy) {
        const double w = std::exp(-surface(x, y, qx, qy, 0));
        Rgb d = difference(c.color[f_.index(qx, qy)], c.color[p]);
        for (double& v : d) v = std::clamp(v, -1e18, 1e18);
        sum += w;
        squares += w * squared(d);
        light += w * std::pow(luminance(d), 2);
        for (int k = 0; k < 3; ++k) mean[k] += w * d[k];
      });
      for (double& v : mean) v /= sum;
      c.noise[p] = std::max(0.0, squares / sum - squared(mean));
      c.luminance[p] = std::max(0.0, light / sum - std::pow(luminance(mean), 2));
    });
  }

  // Variance of the detail of white noise of variance 1 with the plain B3 kernel: what it is, over what
  // follows where the correlation of a level's input is neglected.
  static double correction(int level) {
    constexpr double deviations[] = {0.89080, 0.20066, 0.08551, 0.04122, 0.02042};
    double squares = 0;
    for (int j = -2; j <= 2; ++j)
      for (int i = -2; i <= 2; ++i) squares += std::pow(b3(i) * b3(j), 2);
    const double neglecting = (1 - 2 * b3(0) * b3(0) + squares) * std::pow(squares, level);
    return std::pow(deviations[level], 2) / neglecting;
  }

  const FilterPlan& plan_;
  Features f_;
};

}  // namespace

Image sure_atrous(const FilterPlan& plan, const Image& input) {
  const SureAtrous filter(plan, input);
  const Features& f = filter.features();
  const Coarse finest = filter.finest();
  Coarse c = finest;
  std::vector<Detail> details;
  for (int level = 0; level < plan["levels"]; ++level) {
    details.push_back(filter.no_detail());
    c = filter.coarser(c, finest, level, details.back());
  }
  std::vector<Rgb> result = c.color;
  each_valid(f, [&](int x, int y) {
    for (std::size_t level = 0; level < details.size(); ++level) {
      const double w = filter.weight(details[level], static_cast<int>(level), x, y);
      for (int k = 0; k < 3; ++k) result[f.index(x, y)][k] += w * details[level].difference[f.index(x, y)][k];
    }
  });
  Image out(input.region(), 3);
  const Region& r = input.region();
  for (int k = 0; k < 3; ++k)
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) {
        const double color = f.at(Aov::color, k, x, y), filtered = result[f.index(x, y)][k];
        out.at(k, x, y) = static_cast<float>(f.valid(x, y)          ? std::max(0.0, filtered)
                                             : std::isfinite(color) ? color
                                                                    : 0.0);
      }
  return out;
}

}  // namespace tessera::reference
