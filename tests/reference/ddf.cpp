// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/ddf.h"

#include <algorithm>
#include <cmath>

#include "tests/reference/window.h"

namespace tessera::reference {
namespace {

class Picture {
 public:
  Picture(const FilterPlan& plan, const Image& input)
      : plan_(plan), f_(plan, input), unit_((plan["diameter"] > 0 ? plan["diameter"] : 1) / 10) {}
  const Features& features() const { return f_; }

  // w_d, equation 6.15.
  double direct_weight(int x, int y, int qx, int qy) const {
    return std::exp(-light_scale("sigma_dc", x, y) * distance2(Aov::direct, x, y, qx, qy) -
                    feature_exponent(x, y, qx, qy));
  }
  // w_i, equation 6.16.
  double indirect_weight(int x, int y, int qx, int qy) const {
    double e = light_scale("sigma_ic", x, y) * distance2(Aov::indirect, x, y, qx, qy) +
               feature_exponent(x, y, qx, qy);
    e += scale("sigma_texture2", "s_texture2", Aov::texture2, x, y) * distance2(Aov::texture2, x, y, qx, qy);
    if (plan_.is("direction", "neighbours") && (qx != x || qy != y))
      e += scale("sigma_direction", "s_direction", Aov::bounce, x, y);
    return std::exp(-e);
  }

 private:
  // Equation 6.10: what the variance in pixel (x, y) leaves of the inverse scale of a feature.
  double scale(const char* sigma, const char* spread, Aov aov, int x, int y) const {
    double variance = 0;
    for (int c = 0; c < info(aov).channels; ++c)
      variance += f_.at(aov, c, x, y, Statistic::variance_of_mean) * f_.samples(x, y);
    if (aov == Aov::depth) variance /= unit_ * unit_;
    return (1 - std::clamp(plan_[spread] * variance, 0.0, 1.0)) / (2 * plan_[sigma] * plan_[sigma]);
  }
  // Equations 6.8 and 6.9.
  double light_scale(const char* sigma, int x, int y) const {
    const double noise = plan_.is("progressive", "on") ? 8 / std::max(f_.samples(x, y), 1.0) : 1;
    return 1 / (2 * plan_[sigma] * plan_[sigma] * noise);
  }
  double distance2(Aov aov, int x, int y, int qx, int qy) const {
    return squared(difference(f_.rgb(aov, qx, qy), f_.rgb(aov, x, y)));
  }
  // Of w_fd, equation 6.13.
  double feature_exponent(int x, int y, int qx, int qy) const {
    const double dz = (f_.at(Aov::depth, 0, qx, qy) - f_.at(Aov::depth, 0, x, y)) / unit_;
    return scale("sigma_depth", "s_depth", Aov::depth, x, y) * dz * dz +
           scale("sigma_normal", "s_normal", Aov::normal, x, y) * distance2(Aov::normal, x, y, qx, qy) +
           scale("sigma_texture", "s_texture", Aov::albedo, x, y) * distance2(Aov::albedo, x, y, qx, qy);
  }

  const FilterPlan& plan_;
  Features f_;
  double unit_;  // of depth
};

}  // namespace

Image ddf(const FilterPlan& plan, const Image& input) {
  const Picture picture(plan, input);
  const Features& f = picture.features();
  const int half = static_cast<int>(plan["kw"]) + 1, step = plan.is("holes", "on") ? 2 : 1;
  const int reach = half - half % step;  // whose offsets are multiples of the step
  const Region& r = input.region();
  Image out(r, 3);
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      Rgb direct = f.rgb(Aov::direct, x, y), indirect = f.rgb(Aov::indirect, x, y);
      if (f.valid(x, y)) {
        direct = window_mean(f, Aov::direct, x, y, reach, step,
                             [&](int, int, int qx, int qy) { return picture.direct_weight(x, y, qx, qy); });
        indirect = window_mean(f, Aov::indirect, x, y, reach, step, [&](int, int, int qx, int qy) {
          return picture.indirect_weight(x, y, qx, qy);
        });
      }
      for (int k = 0; k < 3; ++k) {
        const double color = direct[k] + indirect[k] + f.at(Aov::emission, k, x, y);
        out.at(k, x, y) = std::isfinite(color) ? static_cast<float>(color) : 0;
      }
    }
  return out;
}

}  // namespace tessera::reference
