// SPDX-License-Identifier: Apache-2.0
// The edge-avoiding a-trous wavelet transform of Dammertz et al. 2010 (EAW).
#include "core/filter/descriptions.h"

namespace tessera {
namespace {

std::vector<Parameter> parameters() {
  return {
      levels_parameter("Dammertz et al. 2010, section 3"),
      {"sigma_c", "illumination difference that stops the filter at level 0; halves with every level",
       "radiance", "Dammertz et al. 2010, equation 4 (sigma_rt)", 1e-4, 1e4, 1.0},
      sigma_n_parameter("Dammertz et al. 2010, equation 4 (sigma_n)"),
      sigma_x_parameter("Dammertz et al. 2010, equation 4 (sigma_x), made independent of the scene's scale"),
  };
}

std::vector<Channel> inputs(const ParameterValues&) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::emission, Aov::albedo, Aov::normal, Aov::position, Aov::depth});
  return all;
}

std::vector<Pass> passes(const ParameterValues& values) {
  constexpr double kTap = 9 + 15 + 6 + kExpFlops + 1 + 7;  // differences, squares, exponent, weight, sums
  std::vector<Pass> all;
  append_levels(all, {.kernel = "atrous_level", .flops = 24 * kTap + 4 * 8 + 20, .floats = 6 + 3 + 3},
                static_cast<int>(values.find("levels")->second));
  return all;
}

}  // namespace

FilterDescription describe_atrous() {
  return {.name = "atrous",
          .summary = "edge-avoiding a-trous wavelets, steered by colour, normal and position",
          .source =
              "H. Dammertz, D. Sewtz, J. Hanika, H. Lensch: Edge-Avoiding A-Trous Wavelet Transform for fast"
              " Global Illumination Filtering, HPG 2010",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          .scratch = [](const ParameterValues&) { return 6.0 + 2 * 3; }};
}

}  // namespace tessera
