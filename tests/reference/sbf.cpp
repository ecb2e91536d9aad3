// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/sbf.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "tests/reference/features.h"

namespace tessera::reference {
namespace {

class Sbf {
 public:
  Sbf(const FilterPlan& plan, const Image& input)
      : plan_(plan),
        f_(plan, input),
        normals_(guides(Aov::normal, "sigma_n")),
        albedos_(guides(Aov::albedo, "sigma_a")),
        depths_(guides(Aov::depth, "sigma_d", plan["diameter"] > 0 ? plan["diameter"] : 1)) {
    for (int k = 0; k < static_cast<int>(plan["filters"]); ++k)
      candidates_.push_back(filtered(std::pow(2, k / 2.0)));
    if (plan["unfiltered"] == 1) candidates_.push_back(unfiltered());
  }

  const Features& features() const { return f_; }

  // Of the candidate of least smoothed error; of equal ones the narrowest filter, and the noisy one last.
  Rgb chosen(int x, int y) const {
    std::vector<double> errors(candidates_.size());
    each_tap(x, y, plan_["smoothing"], [&](std::size_t q, double w) {
      for (std::size_t k = 0; k < errors.size(); ++k) errors[k] += w * candidates_[k].error[q];
    });
    return candidates_[std::ranges::min_element(errors) - errors.begin()].color[f_.index(x, y)];
  }

 private:
  struct Candidate {
    std::vector<Rgb> color;
    std::vector<double> error;
  };

  Rgb variance(int x, int y) const { return f_.rgb(Aov::color, x, y, Statistic::variance_of_mean); }

  template <typename Body>
  void each_valid(const Body& body) const {
    const Region& r = f_.region();
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x)
        if (f_.valid(x, y)) body(x, y);
  }

  // A feature in units of its sigma, and the variance of its mean in units of the squared unit.
  struct Guide {
    Rgb value{};
    double variance = 0;
  };
  std::vector<Guide> guides(Aov aov, std::string_view sigma, double unit = 1) const {
    std::vector<Guide> all(static_cast<std::size_t>(f_.region().area()));
    each_valid([&](int x, int y) {
      Guide& g = all[f_.index(x, y)];
      for (int c = 0; c < info(aov).channels; ++c) {
        g.value[c] = f_.at(aov, c, x, y) / (unit * plan_[sigma]);
        g.variance += f_.at(aov, c, x, y, Statistic::variance_of_mean) / (unit * unit);
      }
      g.variance = std::min(g.variance, 1e9);  // more counts as that
    });
    return all;
  }

  // Within two sigmas, with the weight of a cross-bilateral filter; 1 for p itself. A feature's exponent is
  // |difference|^2 / (2 sigma^2 max(V_p + V_q, 0.01)).
  template <typename Body>
  void each_tap(int x, int y, double sigma, const Body& body) const {
    const int radius = static_cast<int>(std::ceil(2 * sigma));
    const std::size_t p = f_.index(x, y);
    for (int j = -radius; j <= radius; ++j)
      for (int i = -radius; i <= radius; ++i) {
        if (!f_.valid(x + i, y + j)) continue;
        const std::size_t q = f_.index(x + i, y + j);
        double exponent = (i * i + j * j) / (2 * sigma * sigma);
        for (const std::vector<Guide>* g : {&normals_, &albedos_, &depths_}) {
          const double variance = std::max(0.01, (*g)[p].variance + (*g)[q].variance);
          exponent += squared(difference((*g)[p].value, (*g)[q].value)) / (2 * variance);
        }
        body(q, std::exp(-exponent));
      }
  }

  Candidate unfiltered() const {
    Candidate c = blank();
    each_valid([&](int x, int y) {
      const Rgb v = variance(x, y);
      c.color[f_.index(x, y)] = f_.rgb(Aov::color, x, y);
      c.error[f_.index(x, y)] = v[0] + v[1] + v[2];
    });
    return c;
  }

  Candidate filtered(double sigma) const {
    Candidate c = blank();
    const std::vector<Rgb> noisy = unfiltered().color;
    each_valid([&](int x, int y) {
      double sum = 0;
      Rgb total{};
      each_tap(x, y, sigma, [&](std::size_t q, double w) {
        sum += w;
        for (int k = 0; k < 3; ++k) total[k] += w * noisy[q][k];
      });
      double error = 0;
      for (int k = 0; k < 3; ++k) {
        const double v = variance(x, y)[k];
        c.color[f_.index(x, y)][k] = total[k] / sum;
        error += std::pow(total[k] / sum - noisy[f_.index(x, y)][k], 2) + 2 * v / sum - v;
      }
      c.error[f_.index(x, y)] = std::min(error, 1e34);
    });
    return c;
  }

  Candidate blank() const {
    const std::size_t area = static_cast<std::size_t>(f_.region().area());
    return {std::vector<Rgb>(area), std::vector<double>(area)};
  }

  const FilterPlan& plan_;
  Features f_;
  std::vector<Guide> normals_, albedos_, depths_;
  std::vector<Candidate> candidates_;
};

}  // namespace

Image sbf(const FilterPlan& plan, const Image& input) {
  const Sbf sbf(plan, input);
  const Features& f = sbf.features();
  const Region& r = input.region();
  Image out(r, 3);
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      const Rgb kept = f.rgb(Aov::color, x, y);
      const Rgb c = f.valid(x, y) ? sbf.chosen(x, y) : kept;
      for (int k = 0; k < 3; ++k) out.at(k, x, y) = std::isfinite(c[k]) ? static_cast<float>(c[k]) : 0.0f;
    }
  return out;
}

}  // namespace tessera::reference
