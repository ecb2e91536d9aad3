// SPDX-License-Identifier: Apache-2.0
#include "tests/worker/denoise/cases.h"

namespace tessera {

const std::vector<FilterCase>& filter_cases() {
  // Exponents carry an error of some ulps of up to 127, cosines are raised to a power of 128, five levels add
  // up. Where light spans 60 decades, the smallest weights decide, and the variance that sets them was
  // decided likewise; variance from the picture is then the rounding of a difference of equal moments.
  static const std::vector<FilterCase> cases{
      {.text = "atrous"},
      // Albedos and normals are stored in units of their sigmas: what is rounded off some tens of them is
      // worth 1e-4 of the smallest weights, which decide where the only neighbour is a firefly. A test of
      // means whose sides differ by less than their rounding may fall out either way; of these inputs none
      // does.
      {.text = "statmc", .relative = 5e-4},
      {.text = "svgf"},
      {.text = "svgf:variance=spatial", .extreme = 0},
  };
  return cases;
}

}  // namespace tessera
