// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/separable.h"

#include <cmath>

#include "tests/reference/window.h"

namespace tessera::reference {

Image box(const FilterPlan& plan, const Image& input) {
  const Features f(plan, input);
  const int radius = static_cast<int>(plan["width"]) + 1;
  return of_window(f, radius, 1, [](int, int, int, int) { return 1.0; });
}

Image gaussian(const FilterPlan& plan, const Image& input) {
  const Features f(plan, input);
  const double sigma = plan["sigma"];
  return of_window(f, static_cast<int>(std::ceil(3 * sigma)), 1, [&](int x, int y, int qx, int qy) {
    return gaussian_of((qx - x) * (qx - x) + (qy - y) * (qy - y), sigma);
  });
}

}  // namespace tessera::reference
