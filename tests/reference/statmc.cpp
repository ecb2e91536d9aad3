// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/statmc.h"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "tests/reference/features.h"

namespace tessera::reference {
namespace {

// By Simpson's rule on the density, over the angle whose tangent is t / sqrt(degrees).
double within(double t, double degrees) {
  constexpr int kSteps = 2000;
  const double end = std::atan(t / std::sqrt(degrees));
  double sum = 0;
  for (int k = 0; k <= kSteps; ++k)
    sum += (k == 0 || k == kSteps ? 1 : k % 2 ? 4 : 2) * std::pow(std::cos(end * k / kSteps), degrees - 1);
  const double constant =
      std::exp(std::lgamma((degrees + 1) / 2) - std::lgamma(degrees / 2)) / std::sqrt(std::numbers::pi);
  return 2 * constant * sum * end / kSteps / 3;
}

// A confidence interval of a pixel's mean of one channel.
struct Interval {
  double middle = 0, squared_half_width = 0;
};

class Intervals {
 public:
  Intervals(const FilterPlan& plan, const Features& f) : level_(plan["level"]), f_(f) {}

  Interval of(int x, int y, int channel) {
    const double n = f_.samples(x, y), mean = f_.at(Aov::box_cox, channel, x, y);
    const double variance = f_.at(Aov::box_cox, channel, x, y, Statistic::variance_of_mean);
    const double third = f_.at(Aov::box_cox, channel, x, y, Statistic::third_moment);
    if (n < 2) return {mean, std::numeric_limits<double>::infinity()};
    if (variance == 0) return {mean, 0};
    const double sample_variance = n * variance;
    return {mean + third / (6 * sample_variance * n), std::pow(quantile(n), 2) * variance};
  }

 private:
  double quantile(double n) {
    double& t = quantiles_[n];
    if (t == 0) t = student_quantile(level_, 2 * n - 2);
    return t;
  }

  double level_;
  const Features& f_;
  std::map<double, double> quantiles_;
};

double squared_distance(const Rgb& a, const Rgb& b) { return squared(difference(a, b)); }

}  // namespace

double student_quantile(double level, double degrees) {
  double low = 0, high = 1e4;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (within(middle, degrees) < 1 - level ? low : high) = middle;
  }
  return low;
}

Image statmc(const FilterPlan& plan, const Image& input) {
  const Features f(plan, input);
  const Region& r = input.region();
  const int radius = static_cast<int>(plan["radius"]);
  std::vector<std::array<Interval, 3>> intervals(static_cast<std::size_t>(r.area()));
  Intervals all(plan, f);
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x)
      for (int c = 0; c < 3 && f.valid(x, y); ++c) intervals[f.index(x, y)][c] = all.of(x, y, c);

  const auto differ = [&](std::size_t p, std::size_t q) {
    for (int c = 0; c < 3; ++c) {
      const Interval &a = intervals[p][c], &b = intervals[q][c];
      if (std::pow(a.middle - b.middle, 2) > a.squared_half_width + b.squared_half_width) return true;
    }
    return false;
  };
  const auto gaussian = [](double squared, double sigma) { return std::exp(-squared / (2 * sigma * sigma)); };

  Image out(r, 3);
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      const Rgb color = f.rgb(Aov::color, x, y);
      double sum = 0;
      Rgb total{};
      for (int j = -radius; j <= radius && f.valid(x, y); ++j)
        for (int i = -radius; i <= radius; ++i) {
          const int qx = x + i, qy = y + j, distance2 = i * i + j * j;
          if (distance2 > radius * radius || !f.valid(qx, qy)) continue;
          if (distance2 > 0 && differ(f.index(x, y), f.index(qx, qy))) continue;
          const double w =
              gaussian(distance2, plan["sigma_s"]) *
              gaussian(squared_distance(f.rgb(Aov::albedo, x, y), f.rgb(Aov::albedo, qx, qy)),
                       plan["sigma_a"]) *
              gaussian(squared_distance(f.unit_normal(x, y), f.unit_normal(qx, qy)), plan["sigma_n"]);
          sum += w;
          for (int c = 0; c < 3; ++c) total[c] += w * f.at(Aov::color, c, qx, qy);
        }
      for (int c = 0; c < 3; ++c)
        out.at(c, x, y) = static_cast<float>(f.valid(x, y)             ? total[c] / sum
                                             : std::isfinite(color[c]) ? color[c]
                                                                       : 0.0);
    }
  return out;
}

}  // namespace tessera::reference
