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

std::vector<Channel> inputs() {
  std::vector<Channel> all;
  for (const Aov a : {Aov::direct, Aov::indirect, Aov::emission, Aov::albedo, Aov::normal, Aov::depth})
    for (const Channel& c : channels_of(a)) all.push_back(c);
  for (const Aov a : {Aov::direct, Aov::indirect})
    for (const Channel& c : channels_of(a, Statistic::variance_of_mean)) all.push_back(c);
  return all;
}

}  // namespace

FilterDescription describe_svgf() {
  return {"svgf",
          "five variance-guided a-trous levels; direct and indirect light apart",
          "C. Schied et al.: Spatiotemporal Variance-Guided Filtering, HPG 2017",
          inputs(),
          parameters(),
          [](const ParameterValues& values) {
            const bool picture = values.find("variance")->second == from_picture;
            std::vector<Pass> passes{{picture ? "svgf_variance_spatial" : "svgf_variance_samples", 1, 3}};
            append_levels(passes, "svgf_level", static_cast<int>(values.find("levels")->second));
            return passes;
          }};
}

}  // namespace tessera
