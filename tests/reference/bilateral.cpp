// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/bilateral.h"

#include "tests/reference/window.h"

namespace tessera::reference {
namespace {

int radius_of(const FilterPlan& plan) { return static_cast<int>(plan["width"]) + 1; }

double plain_weight(const FilterPlan& plan, const Features& f, int x, int y, int qx, int qy) {
  const int width = 2 * radius_of(plan) + 1, dx = qx - x, dy = qy - y;
  return gaussian_of(dx * dx + dy * dy, plan["sigma_s"] * width) *
         gaussian_of(squared(difference(f.rgb(Aov::color, qx, qy), f.rgb(Aov::color, x, y))),
                     plan["sigma_r"]);
}

}  // namespace

Image bilateral(const FilterPlan& plan, const Image& input) {
  const Features f(plan, input);
  return of_window(f, radius_of(plan), 1,
                   [&](int x, int y, int qx, int qy) { return plain_weight(plan, f, x, y, qx, qy); });
}

Image cross_bilateral(const FilterPlan& plan, const Image& input) {
  const Features f(plan, input);
  const double unit = (plan["diameter"] > 0 ? plan["diameter"] : 1) / 10;
  return of_window(f, radius_of(plan), 1, [&](int x, int y, int qx, int qy) {
    const Rgb normal = difference(f.unit_normal(qx, qy), f.unit_normal(x, y));
    const Rgb albedo = difference(f.rgb(Aov::albedo, qx, qy), f.rgb(Aov::albedo, x, y));
    const double depth = (f.at(Aov::depth, 0, qx, qy) - f.at(Aov::depth, 0, x, y)) / unit;
    return plain_weight(plan, f, x, y, qx, qy) * gaussian_of(squared(normal), plan["sigma_n"]) *
           gaussian_of(depth * depth, plan["sigma_d"]) * gaussian_of(squared(albedo), plan["sigma_a"]);
  });
}

}  // namespace tessera::reference
