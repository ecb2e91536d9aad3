// SPDX-License-Identifier: Apache-2.0
// The edge-avoiding a-trous wavelet transform of Dammertz et al. 2010 (EAW); with history what Schied et al.
// 2017 compare with: light is accumulated over frames before.
#include "core/filter/descriptions.h"
#include "core/filter/taa.h"

namespace tessera {
namespace {

std::vector<Parameter> parameters() {
  std::vector<Parameter> all{
      levels_parameter("Dammertz et al. 2010, section 3"),
      {"sigma_c", "illumination difference that stops the filter at level 0; halves with every level",
       "radiance", "Dammertz et al. 2010, equation 4 (sigma_rt)", 1e-4, 1e4, 1.0},
      sigma_n_parameter("Dammertz et al. 2010, equation 4 (sigma_n)"),
      sigma_x_parameter("Dammertz et al. 2010, equation 4 (sigma_x), made independent of the scene's scale"),
      history_parameter(),
      alpha_parameter("alpha", "weight of a frame's light in its accumulation over frames"),
      average_parameter(),
  };
  append_taa_parameters(all);
  return all;
}

constexpr int kLight = 3;

int history(const ParameterValues& values) {
  return (with_history(values) ? kLight + kTracePlanes : 0) + taa_history(values);
}

std::vector<Channel> inputs(const ParameterValues& values) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::emission, Aov::albedo, Aov::normal, Aov::position, Aov::depth});
  append_trace(all, values);
  append_taa_inputs(all, values);
  return all;
}

std::vector<Pass> passes(const ParameterValues& values) {
  constexpr double kTap = 9 + 15 + 6 + kLevelWeightFlops + 7;  // differences, squares, exponent, weight, sums
  std::vector<Pass> all;
  constexpr double kSignal = 3 + 3, kGuides = 1 + 1;  // both ways; validity, depth
  if (with_history(values))
    all.push_back(accumulation("atrous_accumulate", kLight, kSignal + kGuides + kLight + kTracePlanes));
  append_levels(all, {.kernel = "atrous_level", .flops = 24 * kTap + 4 * 8 + 20, .floats = 6 + 3 + 3},
                static_cast<int>(values.find("levels")->second));
  append_taa_pass(all, values);
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
          .scratch = [](const ParameterValues& values) { return 6.0 + 2 * 3 + taa_scratch(values); },
          .history = history};
}

}  // namespace tessera
