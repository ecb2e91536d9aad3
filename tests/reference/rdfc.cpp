// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/rdfc.h"

#include <array>

#include "tests/reference/patches.h"

namespace tessera::reference {
namespace {

// A feature's channels, filtered, and what variance is left.
struct Feature {
  std::vector<Plane> value, variance, squared_gradient;
};

class Rdfc {
 public:
  Rdfc(const FilterPlan& plan, const Image& input)
      : plan_(plan), f_(plan, input), area_(static_cast<std::size_t>(input.region().area())) {
    for (int c = 0; c < 3; ++c) {
      color_.picture.push_back(plane_of(f_, Aov::color, c));
      color_.variance.push_back(plane_of(f_, Aov::color, c, Statistic::variance_of_mean));
    }
    const double unit = plan["depth_scale"] > 0 ? plan["depth_scale"] : 1;
    features_ = {feature(Aov::albedo, 1), feature(Aov::normal, 0.5), feature(Aov::depth, 1 / unit)};
  }

  const Features& inputs() const { return f_; }
  const Guide& color() const { return color_; }

  // Filter m with the derivatives of each channel by its own value.
  struct Candidate {
    std::vector<Plane> value, derivative;
  };
  Candidate candidate(int m) const {
    Guide g = color_;
    g.k = plan_["k_c"];
    g.radius = m == 0 ? 1 : 3;
    const double tau = m == 2 ? plan_["tau_features"] : plan_["tau"];
    const std::vector<Plane> zero(3, Plane(area_));
    Plane sum(area_);
    // d(sum w y) / dy and d(sum w) / dy
    std::vector<Plane> total = zero, moved_total = zero, moved_sum = zero;
    each_neighbour(f_, g, static_cast<int>(plan_["window"]), [&](const Neighbours& n) {
      const double d_c = m == 2 ? 0 : n.distance, d_f = feature_distance(n, tau);
      const double w = std::exp(-std::max({0.0, d_c, d_f}));
      const bool decides = m != 2 && d_c > d_f && d_c > 0;
      sum[n.p] += w;
      for (int c = 0; c < 3; ++c) {
        const double y = g.picture[c][n.q];
        total[c][n.p] += w * y;
        const double change = decides ? -w * distance_derivative(g, n, c) : 0;
        moved_sum[c][n.p] += change;
        moved_total[c][n.p] += change * y + (n.p == n.q ? w : 0);
      }
    });
    Candidate result{zero, zero};
    for (int c = 0; c < 3; ++c)
      for (std::size_t p = 0; p < area_; ++p) {
        if (sum[p] == 0) continue;
        const double value = total[c][p] / sum[p];
        result.value[c][p] = value;
        result.derivative[c][p] = (moved_total[c][p] - value * moved_sum[c][p]) / sum[p];
      }
    return result;
  }

  Plane error(const Candidate& a) const {
    Plane mean(area_);
    for (std::size_t p = 0; p < area_; ++p)
      for (int c = 0; c < 3; ++c) {
        const double d = a.value[c][p] - color_.picture[c][p], v = color_.variance[c][p];
        mean[p] += std::clamp(d * d - v + 2 * v * a.derivative[c][p], -1e30, 1e30) / 3;
      }
    return mean;
  }

 private:
  Feature feature(Aov aov, double scale) const {
    Guide g;
    std::vector<Plane> planes;
    const int channels = info(aov).channels;
    for (int c = 0; c < channels; ++c) {
      g.picture.push_back(scaled(plane_of(f_, aov, c), scale));
      g.variance.push_back(scaled(plane_of(f_, aov, c, Statistic::variance_of_mean), scale * scale));
    }
    planes = g.picture;
    for (int c = 0; c < channels; ++c) planes.push_back(scaled(half_difference(aov, c), scale));
    std::vector<Plane> filtered = smoothed(f_, g, 5, planes);
    Feature result;
    for (int c = 0; c < channels; ++c) {
      result.value.push_back(filtered[c]);
      Plane& v = filtered[channels + c];
      for (double& d : v) d *= d;
      result.variance.push_back(v);
      result.squared_gradient.push_back(squared_gradient(filtered[c]));
    }
    return result;
  }

  static Plane scaled(Plane plane, double factor) {
    for (double& v : plane) v *= factor;
    return plane;
  }

  Plane half_difference(Aov aov, int c) const {
    Plane plane(area_);
    each_valid([&](int x, int y) {
      const auto of = [&](Share s) { return f_.at(aov, c, x, y, Statistic::mean, s); };
      const auto samples = [&](Share s) { return f_.at(Aov::color, 0, x, y, Statistic::samples, s); };
      const bool both = samples(Share::a) > 0 && samples(Share::b) > 0 && of(Share::a) < kSkyDepth &&
                        of(Share::b) < kSkyDepth;
      plane[f_.index(x, y)] = both ? (of(Share::a) - of(Share::b)) / 2 : 0;
    });
    return plane;
  }

  Plane squared_gradient(const Plane& v) const {
    Plane result(area_);
    each_valid([&](int x, int y) {
      for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
        double least = INFINITY;
        for (const int side : {-1, 1})
          if (f_.valid(x + side * dx, y + side * dy))
            least = std::min(
                least, std::pow((v[f_.index(x + side * dx, y + side * dy)] - v[f_.index(x, y)]) / 2, 2));
        if (std::isfinite(least)) result[f_.index(x, y)] += least;
      }
    });
    return result;
  }

  // Equation 4 of the paper; a feature of several channels counts by their mean.
  double feature_distance(const Neighbours& n, double tau) const {
    double most = -INFINITY;
    for (const Feature& f : features_) {
      double sum = 0;
      for (std::size_t c = 0; c < f.value.size(); ++c) {
        const double d = f.value[c][n.p] - f.value[c][n.q], vp = f.variance[c][n.p], vq = f.variance[c][n.q];
        sum += (d * d - (vp + std::min(vp, vq))) /
               (std::pow(plan_["k_f"], 2) * std::max({tau, vp, f.squared_gradient[c][n.p]}));
      }
      most = std::max(most, sum / static_cast<double>(f.value.size()));
    }
    return most;
  }

  // Of the patches' distance by channel c of pixel p, which lies at the middle of its own patch and, if it is
  // near, in its neighbour's.
  double distance_derivative(const Guide& g, const Neighbours& n, int c) const {
    const auto slope = [&](std::size_t a, std::size_t b) {  // d/dy_a of the distance of a and b
      return 2 * (g.picture[c][a] - g.picture[c][b]) /
             (g.epsilon + g.k * g.k * (g.variance[c][a] + g.variance[c][b]));
    };
    double sum = slope(n.p, n.q);
    const bool near = std::max(std::abs(n.i), std::abs(n.j)) <= g.radius && n.p != n.q;
    if (near && f_.valid(n.x - n.i, n.y - n.j)) sum += slope(n.p, f_.index(n.x - n.i, n.y - n.j));
    return sum / (3.0 * n.pairs);
  }

  template <typename Body>
  void each_valid(const Body& body) const {
    const Region& r = f_.region();
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x)
        if (f_.valid(x, y)) body(x, y);
  }

  const FilterPlan& plan_;
  Features f_;
  std::size_t area_;
  Guide color_;
  std::vector<Feature> features_;
};

}  // namespace

RdfcCandidate rdfc_candidate(const FilterPlan& plan, const Image& input, int candidate, int c) {
  const Rdfc::Candidate all = Rdfc(plan, input).candidate(candidate);
  return {all.value[c], all.derivative[c]};
}

Image rdfc(const FilterPlan& plan, const Image& input) {
  const Rdfc rdfc(plan, input);
  const Features& f = rdfc.inputs();
  std::vector<Rdfc::Candidate> candidates;
  std::vector<Plane> errors;
  for (int m = 0; m < 3; ++m) {
    candidates.push_back(rdfc.candidate(m));
    errors.push_back(rdfc.error(candidates.back()));
  }
  errors = smoothed(f, rdfc.color(), 1, errors);
  std::vector<Plane> shares(3, Plane(errors[0].size()));
  for (std::size_t p = 0; p < errors[0].size(); ++p) {
    const std::array e{errors[0][p], errors[1][p], errors[2][p]};
    shares[static_cast<std::size_t>(std::ranges::min_element(e) - e.begin())][p] = 1;
  }
  shares = smoothed(f, rdfc.color(), 5, shares);
  for (int m = 0; m < 3; ++m)
    if (plan["take"] > 0) std::ranges::fill(shares[m], plan["take"] == m + 1 ? 1.0 : 0.0);
  Image out(input.region(), 3);
  for (int c = 0; c < 3; ++c)
    for (int y = out.region().y0; y < out.region().y1; ++y)
      for (int x = out.region().x0; x < out.region().x1; ++x) {
        double sum = 0;
        for (int m = 0; m < 3; ++m) sum += shares[m][f.index(x, y)] * candidates[m].value[c][f.index(x, y)];
        const double color = f.at(Aov::color, c, x, y);
        out.at(c, x, y) = static_cast<float>(f.valid(x, y) ? sum : std::isfinite(color) ? color : 0.0);
      }
  return out;
}

}  // namespace tessera::reference
