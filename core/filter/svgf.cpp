// SPDX-License-Identifier: Apache-2.0
// Variance-guided filtering of Schied et al. 2017 (SVGF) in its single-frame form: no history, so the
// variance comes from the picture or from the renderer's samples.
#include "core/filter/descriptions.h"

namespace tessera {
namespace {

constexpr double from_picture = 0, from_samples = 1;  // choices of `variance`

std::vector<Parameter> parameters() {
  return {
      levels_parameter("Schied et al. 2017, section 4.3"),
      {"sigma_z", "deviation from the local plane in depth that stops the filter", "planes",
       "Schied et al. 2017, equation 3 and section 4.4", 0.01, 100, 1.0},
      {"sigma_n",
       "exponent of the cosine between normals",
       "1",
       "Schied et al. 2017, equation 4 and section 4.4",
       0,
       10,
       7,
       true,
       {"1", "2", "4", "8", "16", "32", "64", "128", "256", "512", "1024"}},
      {"sigma_l", "luminance difference that stops the filter, in standard deviations", "1",
       "Schied et al. 2017, equation 5 and section 4.4", 0.01, 1000, 4.0},
      {"variance",
       "where the variance comes from: the 7x7 neighbourhood, or the renderer's samples smoothed over it",
       "",
       "Schied et al. 2017, section 4.2; its section 6 advises a conventional variance at higher sample "
       "counts",
       from_picture,
       from_samples,
       from_samples,
       true,
       {"spatial", "samples"}},
  };
}

std::vector<Channel> inputs(const ParameterValues&) {
  std::vector<Channel> all;
  append(all, {Aov::direct, Aov::indirect, Aov::emission, Aov::albedo, Aov::normal, Aov::depth});
  append(all, {Aov::direct, Aov::indirect}, Statistic::variance_of_mean);
  return all;
}

std::vector<Pass> passes(const ParameterValues& values) {
  constexpr double kGeometry = 2 + 5 + 2 + 7;  // depth, cosine, bounds, seven squarings
  constexpr double kChord = 7.0 / 2;           // half a depth scale per tap
  constexpr double kLightTap = 3 + 5 + 3 + kExpFlops + 1 + 1 + 6 + 3;  // differences, luminance, weight, sums
  constexpr double kFloats = 4 + 8 + 8;
  std::vector<Pass> all;
  if (values.find("variance")->second == from_picture)
    all.push_back(
        {"svgf_variance_spatial", 1, 3, 48 * (kGeometry + kChord + kExpFlops + 2 + 2 * 17) + 40, kFloats});
  else
    all.push_back({"svgf_variance_samples", 1, 3, 48 * (kGeometry + kChord + kExpFlops + 6) + 20, kFloats});
  append_levels(all,
                {.kernel = "svgf_level",
                 .flops = 24 * (kGeometry + kChord + 2 * kLightTap) + 2 * (9 * 4 + 20) + 20,
                 .floats = kFloats},
                static_cast<int>(values.find("levels")->second));
  return all;
}

}  // namespace

FilterDescription describe_svgf() {
  return {.name = "svgf",
          .summary = "five variance-guided a-trous levels; direct and indirect light apart",
          .source = "C. Schied et al.: Spatiotemporal Variance-Guided Filtering, HPG 2017",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          .scratch = [](const ParameterValues&) { return 4.0 + 2 * 8; }};
}

}  // namespace tessera
