// SPDX-License-Identifier: Apache-2.0
// The SURE-based a-trous wavelet filter of Kim et al. 2016: the levels of EAW, whose details come back as far
// as Stein's unbiased risk estimate finds more in them than noise.
#include "core/filter/descriptions.h"

namespace tessera {
namespace {

bool is(const ParameterValues& values, std::string_view parameter, int choice) {
  return values.find(parameter)->second == choice;
}
int number(const ParameterValues& values, std::string_view parameter) {
  return static_cast<int>(values.find(parameter)->second);
}

// Choices of the parameters, by their index.
constexpr int literal = 1, svgf = 1, depth = 1, spatial = 1;

std::vector<Parameter> parameters() {
  return {
      levels_parameter("Kim et al. 2016, section 2"),
      {"mode",
       "how details are weighed: valid, by the least risk of a linear shrinkage of noise of known variance;"
       " literal, by the risk as it is printed, which takes a fifth of every detail",
       "",
       "Kim et al. 2016, section 2.2 and equation 2",
       0,
       1,
       0,
       true,
       {"valid", "literal"}},
      {"weights",
       "of the valid mode: any from 0 to 1, or the best of 0, 0.2, ... 1",
       "",
       "Kim et al. 2016, section 2.2 (0.2, 0.4, 0.6, 0.8)",
       0,
       1,
       0,
       true,
       {"continuous", "grid"}},
      {"window",
       "radius of the window over which the risk is averaged at level 0; doubles with every level, its taps "
       "2^i pixels apart",
       "pixels", "Kim et al. 2016, section 2.2 (a single pixel: 0)", 0, 4, 2, true},
      {"edge",
       "how illumination stops the filter: paper, by its squared difference over the variance of the pixel's "
       "mean, halving as a deviation with every level; svgf, by that of luminance in deviations that are "
       "propagated",
       "",
       "Kim et al. 2016, section 2.1; Schied et al. 2017, equation 5",
       0,
       1,
       0,
       true,
       {"paper", "svgf"}},
      {"sigma_y", "illumination difference that stops the filter, in standard deviations (edge=paper)", "1",
       "Kim et al. 2016, section 2.1 (1)", 0.01, 1000, 1.0},
      {"sigma_l", "luminance difference that stops the filter, in standard deviations (edge=svgf)", "1",
       "Schied et al. 2017, equation 5 and section 4.4", 0.01, 1000, 4.0},
      sigma_n_parameter("Dammertz et al. 2010, equation 4 (sigma_n), as Kim et al. 2016 adopt it"),
      {"distance",
       "what tells surfaces apart beside the normal: points of the surface, or depth and its slope",
       "",
       "Kim et al. 2016, algorithm 1 (position) and section 3 (depth)",
       0,
       1,
       0,
       true,
       {"position", "depth"}},
      sigma_x_parameter("Dammertz et al. 2010, equation 4 (sigma_x), made independent of the scene's scale"),
      {"sigma_z", "deviation from the local plane in depth that stops the filter (distance=depth)", "planes",
       "Schied et al. 2017, equation 3 and section 4.4", 0.01, 100, 1.0},
      {"variance",
       "where the noise's variance comes from: the renderer's samples, or the 7x7 neighbourhood, for a "
       "single "
       "sample per pixel has none",
       "",
       "Kim et al. 2016, section 2.1; Schied et al. 2017, section 4.2",
       0,
       1,
       0,
       true,
       {"samples", "spatial"}},
  };
}

std::vector<Channel> inputs(const ParameterValues& values) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::normal, Aov::depth});
  if (!is(values, "variance", spatial)) append(all, {Aov::color}, Statistic::variance_of_mean);
  if (!is(values, "distance", depth)) append(all, {Aov::position});
  return all;
}

// Planes of a pixel: position or depth and the normal; a level's colour and variances.
int guide_planes(const ParameterValues& values) { return is(values, "distance", depth) ? 4 : 6; }
int level_planes(const ParameterValues& values) { return is(values, "edge", svgf) ? 5 : 4; }

std::vector<Pass> passes(const ParameterValues& values) {
  const bool by_depth = is(values, "distance", depth), by_luminance = is(values, "edge", svgf),
             valid = !is(values, "mode", literal);
  const int levels = number(values, "levels"), window = number(values, "window");
  const double surface = (by_depth ? 2 + 7.0 / 2 : 3 + 5) + 3 + 5 + 4;  // differences, squares, exponent
  const double tap = surface + 3 + (by_luminance ? 6 : 5) + kLevelWeightFlops + 1 + 6;
  const double noise = valid ? 3 : 0, deviation = by_luminance ? 3 : 0;
  const double kept = level_planes(values);
  std::vector<Pass> all;
  if (is(values, "variance", spatial))
    all.push_back({"sure_variance", 1, 3, 48 * (surface + kLevelWeightFlops + 1 + 3 + 5 + 6 + 3) + 30,
                   guide_planes(values) + 3 + 1.0});
  append_levels(all,
                {.kernel = "sure_level",
                 .flops = 24 * (tap + noise + deviation) + 60,
                 .floats = guide_planes(values) + 2 * kept + (valid ? 2 : 0)},
                levels);
  const double taps = (2 * window + 1) * (2 * window + 1);
  // A weight of each level, which takes the place of its noise; all by the pass of the widest window.
  if (valid)
    all.push_back(
        {"sure_weights", 1 << (levels - 1), window << (levels - 1), levels * (2 * taps + 4), 3.0 * levels});
  all.push_back({"sure_reconstruct", 1, 0, 9.0 * levels, 3.0 * (levels + 1) + (valid ? levels : 0) + 6});
  return all;
}

double scratch(const ParameterValues& values) {
  const int levels = number(values, "levels");
  return guide_planes(values) + (levels + 1) * level_planes(values) +
         (is(values, "mode", literal) ? 0 : 2 * levels);
}

}  // namespace

FilterDescription describe_sure_atrous() {
  return {.name = "sure-atrous",
          .summary = "a-trous wavelets whose details are kept as far as they are more than noise",
          .source =
              "S. Kim, B. Moon, S.-E. Yoon: SURE-based A-Trous Wavelet Filter for Interactive Monte Carlo"
              " Rendering, Journal of KIISE 43(8), 2016",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          .scratch = scratch};
}

}  // namespace tessera
