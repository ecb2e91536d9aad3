// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/window.h"

#include <cmath>

namespace tessera::reference {

Rgb window_mean(const Features& f, Aov aov, int x, int y, int radius, int step, const Weight& weight) {
  double sum = 0;
  Rgb total{};
  for (int qy = y - radius; qy <= y + radius; ++qy)
    for (int qx = x - radius; qx <= x + radius; ++qx) {
      if ((qx - x) % step != 0 || (qy - y) % step != 0 || !f.valid(qx, qy)) continue;
      const double w = weight(x, y, qx, qy);
      const Rgb c = f.rgb(aov, qx, qy);
      sum += w;
      for (int k = 0; k < 3; ++k) total[k] += w * c[k];
    }
  if (sum == 0) return {};
  return {total[0] / sum, total[1] / sum, total[2] / sum};
}

Image of_window(const Features& f, int radius, int step, const Weight& weight) {
  Image out(f.region(), 3);
  const Region& r = f.region();
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      Rgb color = f.rgb(Aov::color, x, y);
      if (f.valid(x, y)) color = window_mean(f, Aov::color, x, y, radius, step, weight);
      for (int k = 0; k < 3; ++k)
        out.at(k, x, y) = std::isfinite(color[k]) ? static_cast<float>(color[k]) : 0;
    }
  return out;
}

double gaussian_of(double squared, double sigma) { return std::exp(-squared / (2 * sigma * sigma)); }

}  // namespace tessera::reference
