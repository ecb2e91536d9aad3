// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/nfor.h"

#include <array>
#include <utility>

#include "tests/reference/patches.h"

namespace tessera::reference {
namespace {

constexpr int kColumns = 9;  // dx, dy, albedo, normal, depth
using Columns = std::array<double, kColumns>;
using Planes = std::vector<Plane>;

// A plane: value at the window's centre plus slopes.
struct Fit {
  double constant = 0;
  Columns slopes{};
};

// Weighted sums over a window.
struct Sums {
  double weight = 0;
  Columns column{};
  std::array<Columns, kColumns> product{};
  Rgb light{};
  std::array<Columns, 3> light_column{};
};

// Gauss's elimination; m is symmetric and positive definite.
Columns solved(std::array<Columns, kColumns> m, Columns b) {
  for (int i = 0; i < kColumns; ++i)
    for (int j = i + 1; j < kColumns; ++j) {
      const double factor = m[j][i] / m[i][i];
      for (int k = i; k < kColumns; ++k) m[j][k] -= factor * m[i][k];
      b[j] -= factor * b[i];
    }
  for (int i = kColumns - 1; i >= 0; --i) {
    for (int k = i + 1; k < kColumns; ++k) b[i] -= m[i][k] * b[k];
    b[i] /= m[i][i];
  }
  return b;
}

Fit fit_of(const Sums& s, int channel, double ridge) {
  Columns mean = s.column, right{};
  std::array<Columns, kColumns> covariance{};
  const double level = s.light[channel] / s.weight;
  for (double& m : mean) m /= s.weight;
  for (int a = 0; a < kColumns; ++a) {
    for (int b = 0; b < kColumns; ++b) covariance[a][b] = s.product[a][b] / s.weight - mean[a] * mean[b];
    covariance[a][a] = std::max(covariance[a][a], 0.0) * (1 + ridge) + 1e-8;
    right[a] = s.light_column[channel][a] / s.weight - mean[a] * level;
  }
  Fit fit{level, solved(covariance, right)};
  for (int a = 0; a < kColumns; ++a) fit.constant -= fit.slopes[a] * mean[a];
  return fit;
}

class Nfor {
 public:
  Nfor(const FilterPlan& plan, const Image& input)
      : plan_(plan), f_(plan, input), area_(static_cast<std::size_t>(input.region().area())) {}

  const Features& inputs() const { return f_; }

  Planes filtered() const {
    const Planes whole = color(Share::all), a = color(Share::a), b = color(Share::b);
    Planes variance(3), half_variance(3);
    for (int c = 0; c < 3; ++c) {
      variance[c] = plane_of(f_, Aov::color, c, Statistic::variance_of_mean);
      half_variance[c] = scaled(variance[c], 2);
    }
    const Planes features_a = features(Share::a, Share::b), features_b = features(Share::b, Share::a);
    std::array<Planes, 2> filtered_a, filtered_b;
    Planes errors(2);
    for (const int m : {0, 1}) {
      const double k = plan_[m == 0 ? "k_narrow" : "k_wide"];
      filtered_a[m] = regressed(a, b, half_variance, features_b, k);
      filtered_b[m] = regressed(b, a, half_variance, features_a, k);
      errors[m] = error(a, b, variance, filtered_a[m], filtered_b[m]);
    }
    const Guide guide{whole, variance, 1, 1e-7, 1e4, 1};
    errors = smoothed(f_, guide, window(), errors);
    Planes share(1, Plane(area_));
    for (std::size_t p = 0; p < area_; ++p) share[0][p] = errors[1][p] < errors[0][p] ? 1 : 0;
    share = smoothed(f_, guide, window(), share);
    for (int c = 0; c < 3; ++c)
      for (std::size_t p = 0; p < area_; ++p)
        for (auto* half : {&filtered_a, &filtered_b})
          (*half)[0][c][p] += share[0][p] * ((*half)[1][c][p] - (*half)[0][c][p]);
    const auto [result, result_variance] = combined(filtered_a[0], filtered_b[0]);
    return regressed(result, result, result_variance, last_features(features_a, features_b),
                     plan_["k_final"]);
  }

 private:
  static constexpr std::array kFeatures{Aov::albedo, Aov::normal, Aov::depth};

  int window() const { return static_cast<int>(plan_["window"]); }
  static Plane scaled(Plane plane, double factor) {
    for (double& v : plane) v *= factor;
    return plane;
  }

  // A half's channel; the whole's where the half has no samples or saw nothing but sky.
  Plane half(Aov aov, int c, Share share) const {
    Plane plane = plane_of(f_, aov, c, Statistic::mean, share);
    if (share == Share::all) return plane;
    const Plane whole = plane_of(f_, aov, c);
    const Plane samples = plane_of(f_, Aov::color, 0, Statistic::samples, share);
    for (std::size_t p = 0; p < area_; ++p)
      if (samples[p] == 0 || plane[p] >= kSkyDepth) plane[p] = whole[p];
    return plane;
  }
  Planes color(Share share) const {
    return {half(Aov::color, 0, share), half(Aov::color, 1, share), half(Aov::color, 2, share)};
  }

  // Of `filtered`, by the weights of `guide`.
  Planes features(Share filtered, Share guide) const {
    Planes all;
    for (const Aov aov : kFeatures) {
      const double unit = aov != Aov::depth || plan_["depth_scale"] == 0 ? 1 : plan_["depth_scale"];
      Guide g{{}, {}, 0.5, 1e-7, 1e4, 3};
      Planes from;
      for (int c = 0; c < info(aov).channels; ++c) {
        g.picture.push_back(scaled(half(aov, c, guide), 1 / unit));
        g.variance.push_back(scaled(plane_of(f_, aov, c, Statistic::variance_of_mean), 2 / (unit * unit)));
        from.push_back(scaled(half(aov, c, filtered), 1 / unit));
      }
      for (Plane& plane : smoothed(f_, g, 5, from)) all.push_back(std::move(plane));
    }
    return all;
  }

  static std::pair<Planes, Planes> combined(const Planes& a, const Planes& b) {
    Planes mean = a, variance = a;
    for (std::size_t c = 0; c < a.size(); ++c)
      for (std::size_t p = 0; p < a[c].size(); ++p) {
        mean[c][p] = (a[c][p] + b[c][p]) / 2;
        variance[c][p] = std::pow(b[c][p] - a[c][p], 2) / 4;
      }
    return {mean, variance};
  }

  Planes last_features(const Planes& a, const Planes& b) const {
    const auto [mean, variance] = combined(a, b);
    Planes all;
    for (std::size_t first = 0; first < mean.size(); first += 3) {
      const auto part = [&](const Planes& of) {
        return Planes(of.begin() + static_cast<std::ptrdiff_t>(first),
                      of.begin() + static_cast<std::ptrdiff_t>(std::min(first + 3, of.size())));
      };
      const Guide g{part(mean), part(variance), 0.5, 1e-7, 1e4, 3};
      for (Plane& plane : smoothed(f_, g, 2, g.picture)) all.push_back(std::move(plane));
    }
    return all;
  }

  Plane error(const Planes& a, const Planes& b, const Planes& variance, const Planes& fa,
              const Planes& fb) const {
    Plane mean(area_);
    for (std::size_t p = 0; p < area_; ++p)
      for (int c = 0; c < 3; ++c) {
        const double in_a = std::pow(b[c][p] - fa[c][p], 2) - 2 * variance[c][p],
                     in_b = std::pow(a[c][p] - fb[c][p], 2) - 2 * variance[c][p];
        mean[p] += std::clamp((in_a + in_b) / 2 - std::pow(fb[c][p] - fa[c][p], 2) / 4, -1e30, 1e30) / 3;
      }
    return mean;
  }

  Columns columns(const Neighbours& n, const Planes& features) const {
    Columns x{double(n.i) / window(), double(n.j) / window()};
    for (std::size_t k = 0; k < features.size(); ++k) x[2 + k] = features[k][n.q] - features[k][n.p];
    return x;
  }

  Planes regressed(const Planes& picture, const Planes& guide, const Planes& variance, const Planes& features,
                   double k) const {
    const Guide g{guide, variance, k, 1e-7, 1e4, 3};
    std::vector<Sums> sums(area_);
    each_neighbour(f_, g, window(), [&](const Neighbours& n) {
      const double w = std::exp(-std::max(0.0, n.distance));
      const Columns x = columns(n, features);
      Sums& s = sums[n.p];
      s.weight += w;
      for (int a = 0; a < kColumns; ++a) {
        s.column[a] += w * x[a];
        for (int b = 0; b < kColumns; ++b) s.product[a][b] += w * x[a] * x[b];
        for (int c = 0; c < 3; ++c) s.light_column[c][a] += w * x[a] * (picture[c][n.q] - picture[c][n.p]);
      }
      for (int c = 0; c < 3; ++c) s.light[c] += w * (picture[c][n.q] - picture[c][n.p]);
    });
    std::vector<std::array<Fit, 3>> fits(area_);
    for (std::size_t p = 0; p < area_; ++p)
      for (int c = 0; c < 3; ++c)
        if (sums[p].weight > 0) fits[p][c] = fit_of(sums[p], c, plan_["ridge"]);
    Plane weight(area_);
    Planes total(3, Plane(area_));
    each_neighbour(f_, g, window(), [&](const Neighbours& n) {
      const double w = std::exp(-std::max(0.0, n.distance));
      const Columns x = columns(n, features);
      weight[n.q] += w;
      for (int c = 0; c < 3; ++c) {
        double predicted = picture[c][n.p] + fits[n.p][c].constant;
        for (int a = 0; a < kColumns; ++a) predicted += fits[n.p][c].slopes[a] * x[a];
        total[c][n.q] += w * predicted;
      }
    });
    for (Plane& t : total)
      for (std::size_t p = 0; p < area_; ++p) t[p] = weight[p] > 0 ? t[p] / weight[p] : 0;
    return total;
  }

  const FilterPlan& plan_;
  Features f_;
  std::size_t area_;
};

}  // namespace

Image nfor(const FilterPlan& plan, const Image& input) {
  const Nfor nfor(plan, input);
  const Features& f = nfor.inputs();
  const Planes result = nfor.filtered();
  Image out(input.region(), 3);
  for (int c = 0; c < 3; ++c)
    for (int y = out.region().y0; y < out.region().y1; ++y)
      for (int x = out.region().x0; x < out.region().x1; ++x) {
        const double color = f.at(Aov::color, c, x, y);
        out.at(c, x, y) = static_cast<float>(f.valid(x, y)          ? result[c][f.index(x, y)]
                                             : std::isfinite(color) ? color
                                                                    : 0.0);
      }
  return out;
}

}  // namespace tessera::reference
