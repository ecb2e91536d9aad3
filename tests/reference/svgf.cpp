// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/svgf.h"

#include <algorithm>
#include <cmath>

#include "core/filter/descriptions.h"
#include "tests/reference/history.h"
#include "tests/reference/surface.h"

namespace tessera::reference {
namespace {

// Direct or indirect illumination, the variance of its luminance, and over the frames the luminance's mean.
struct Light {
  std::vector<Rgb> color;
  std::vector<double> variance, mean;
};

bool can_be_light(float v) { return std::abs(v) <= 1e32f; }
bool can_be_variance(float v) { return v >= 0 && v <= 1e36f; }

class Svgf {
 public:
  Svgf(const FilterPlan& plan, const Image& input) : plan_(plan), f_(plan, input), lengths_(area(), 1.0) {}

  const Features& features() const { return f_; }

  Light light(Aov aov) const {
    Light l{std::vector<Rgb>(area()), std::vector<double>(area()), std::vector<double>(area())};
    each_valid(f_, [&](int x, int y) {
      const Rgb c = f_.rgb(aov, x, y), albedo = floored(f_.rgb(Aov::albedo, x, y));
      const Rgb v = spatial() ? Rgb{} : f_.rgb(aov, x, y, Statistic::variance_of_mean);
      Rgb deviation{};
      for (int k = 0; k < 3; ++k) {
        l.color[f_.index(x, y)][k] = c[k] / albedo[k];
        deviation[k] = std::sqrt(v[k]) / albedo[k];
      }
      l.variance[f_.index(x, y)] = std::pow(luminance(deviation), 2);
    });
    return l;
  }

  // Joins the light of both kinds, first[0] and first[1], with what was kept of it.
  void accumulate(Light* const (&lights)[2], const Image& history) {
    each_valid(f_, [&](int x, int y) {
      const std::size_t p = f_.index(x, y);
      const auto pixels = past_pixels(f_, history.region(), x, y, [&](int qx, int qy) {
        return plausible(history, qx, qy) && same_surface(f_, x, y, history, length_plane() + 1, qx, qy);
      });
      const double length = lengths_[p] = history_length(history, length_plane(), pixels);
      for (int s = 0; s < 2; ++s) {
        accumulate_color(lights[s]->color[p], history, 3 * s, pixels, weight_of_now(plan_, "alpha", length));
        if (!spatial())
          accumulate_variance(lights[s]->variance[p], history, 6 + s, pixels,
                              weight_of_now(plan_, "alpha", length));
      }
    });
  }
  // Before accumulate(): the moments of the luminance of this frame's light.
  void accumulate_moments(Light* const (&lights)[2], const Image& history) {
    each_valid(f_, [&](int x, int y) {
      const std::size_t p = f_.index(x, y);
      const auto pixels = past_pixels(f_, history.region(), x, y, [&](int qx, int qy) {
        return plausible(history, qx, qy) && same_surface(f_, x, y, history, length_plane() + 1, qx, qy);
      });
      const double a = weight_of_now(plan_, "alpha_moments", history_length(history, length_plane(), pixels));
      for (int s = 0; s < 2; ++s) {
        const double now = luminance(lights[s]->color[p]);
        const double first = a * now + (1 - a) * mean_of_plane(pixels, history, 6 + 2 * s);
        const double second = a * now * now + (1 - a) * mean(pixels, [&](int qx, int qy) {
                                                return history.at(7 + 2 * s, qx, qy) +
                                                       std::pow(history.at(6 + 2 * s, qx, qy), 2);
                                              });
        lights[s]->mean[p] = first;
        lights[s]->variance[p] = pixels.empty() ? 0 : std::max(0.0, second - first * first);
      }
    });
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
      const bool of_frames = spatial() && lengths_[f_.index(x, y)] >= 4;
      estimate[f_.index(x, y)] = of_frames   ? l.variance[f_.index(x, y)]
                                 : spatial() ? std::max(0.0, second / sum - std::pow(first / sum, 2))
                                             : mean / sum;
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

  bool spatial() const { return plan_.is("variance", "spatial"); }
  int length_plane() const { return spatial() ? 10 : 8; }
  double length(int x, int y) const { return lengths_[f_.index(x, y)]; }

 private:
  bool plausible(const Image& history, int x, int y) const {
    bool fit = plausible_length(history.at(length_plane(), x, y)) > 0;
    for (int c = 0; c < 6; ++c) fit &= can_be_light(history.at(c, x, y));
    for (int s = 0; s < 2; ++s)
      fit &= spatial()
                 ? can_be_light(history.at(6 + 2 * s, x, y)) && can_be_variance(history.at(7 + 2 * s, x, y))
                 : can_be_variance(history.at(6 + s, x, y));
    return fit;
  }
  static void accumulate_color(Rgb& color, const Image& history, int first,
                               const std::vector<PastPixel>& pixels, double a) {
    for (int k = 0; k < 3; ++k) color[k] = a * color[k] + (1 - a) * mean_of_plane(pixels, history, first + k);
  }
  static void accumulate_variance(double& variance, const Image& history, int plane,
                                  const std::vector<PastPixel>& pixels, double a) {
    variance = a * a * variance + (1 - a) * (1 - a) * mean_of_plane(pixels, history, plane);
  }

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
  std::vector<double> lengths_;
};

// After `levels` levels of both.
void keep_light(const Svgf& svgf, const Light* const (&lights)[2], Image& kept) {
  const Features& f = svgf.features();
  each_valid(f, [&](int x, int y) {
    for (int s = 0; s < 2; ++s)
      for (int k = 0; k < 3; ++k)
        kept.at(3 + 3 * s + k, x, y) = static_cast<float>(lights[s]->color[f.index(x, y)][k]);
  });
}

void keep_rest(const Svgf& svgf, const Light* const (&lights)[2], Image& kept) {
  const Features& f = svgf.features();
  each_valid(f, [&](int x, int y) {
    std::vector<double> values;
    for (const Light* l : lights) {
      if (svgf.spatial()) values.push_back(l->mean[f.index(x, y)]);
      values.push_back(l->variance[f.index(x, y)]);
    }
    values.push_back(svgf.length(x, y));
    std::ranges::copy(trace(f, x, y), std::back_inserter(values));
    for (std::size_t k = 0; k < values.size(); ++k)
      kept.at(3 + 6 + static_cast<int>(k), x, y) = static_cast<float>(values[k]);
  });
}

}  // namespace

Image svgf(const FilterPlan& plan, const Image& input, const Image& history) {
  Svgf svgf(plan, input);
  const Features& f = svgf.features();
  const Region& r = input.region();
  Image out(r, 3 + plan.history());
  Light direct = svgf.light(Aov::direct), indirect = svgf.light(Aov::indirect);
  Light* const lights[] = {&direct, &indirect};
  const Light* const both[] = {&direct, &indirect};
  const bool temporal = with_history(plan.parameters);
  if (temporal) {
    if (svgf.spatial()) svgf.accumulate_moments(lights, history);
    svgf.accumulate(lights, history);
    keep_rest(svgf, both, out);
    keep_light(svgf, both, out);
  }
  for (Light* l : lights) svgf.estimate_variance(*l);
  int levels = 0;
  for (const Pass& pass : plan.passes()) {
    if (!pass.kernel.ends_with("level")) continue;
    for (Light* l : lights) svgf.level(*l, pass.step);
    if (temporal && ++levels <= plan["feedback"]) keep_light(svgf, both, out);
  }
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
