// SPDX-License-Identifier: Apache-2.0
// Variance-guided filtering of Schied et al. 2017 (SVGF): of single frames, whose variance comes from the
// picture or from the renderer's samples, or with its history.
#include "core/filter/descriptions.h"
#include "core/filter/taa.h"

namespace tessera {
namespace {

constexpr double from_picture = 0, from_samples = 1;  // choices of `variance`

// What is known of the luminances' variances is kept too: two moments each, or how large they are.
int kept_statistics(const ParameterValues& values) {
  return values.find("variance")->second == from_picture ? 4 : 2;
}

int history(const ParameterValues& values) {
  return (with_history(values) ? 6 + kept_statistics(values) + kTracePlanes : 0) + taa_history(values);
}

std::vector<Parameter> parameters() {
  std::vector<Parameter> all{
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
      choice_parameter("variance",
                       "where the variance comes from. spatial: from the 7x7 neighbourhood; with history, "
                       "where that is at "
                       "least 4 frames long, from its frames. samples: from the renderer's samples; with "
                       "history, as much of "
                       "it as averaging the frames leaves; smoothed over 7x7 pixels",
                       "spatial: Schied et al. 2017, section 4.2; samples: its section 5.6 advises a "
                       "conventional variance "
                       "at higher sample counts",
                       {"spatial", "samples"}, from_samples),
      history_parameter(),
      alpha_parameter("alpha", "weight of a frame's light in its accumulation over frames"),
      alpha_parameter("alpha_moments",
                      "weight of a frame in the accumulation of luminance's moments "
                      "(variance=spatial)"),
      average_parameter(),
      {"feedback",
       "after how many levels the light is kept for the next frame; 0: as it was accumulated; at most all "
       "levels",
       "levels", "Schied et al. 2017, section 4.3", 0, 5, 1, true},
  };
  append_taa_parameters(all);
  return all;
}

std::vector<Channel> inputs(const ParameterValues& values) {
  std::vector<Channel> all;
  append(all, {Aov::direct, Aov::indirect, Aov::emission, Aov::albedo, Aov::normal, Aov::depth});
  if (values.find("variance")->second != from_picture)
    append(all, {Aov::direct, Aov::indirect}, Statistic::variance_of_mean);
  append_trace(all, values);
  append_taa_inputs(all, values);
  return all;
}

std::vector<Pass> passes(const ParameterValues& values) {
  constexpr double kGeometry = 3 + 6 + 6;  // depth, cosine, its power's exponent
  constexpr double kChord = 7.0 / 2;       // half a depth scale per tap
  constexpr double kLightTap =
      3 + 5 + 3 + kLevelWeightFlops + 1 + 6 + 3;  // differences, luminance, weight, sums
  constexpr double kFloats = 4 + 8 + 8;
  std::vector<Pass> all;
  if (with_history(values)) {
    const int statistics = kept_statistics(values);
    const double luminance = values.find("variance")->second == from_picture ? 2 : 0;
    constexpr double kSignal = 8 + 8,
                     kGuides = 1 + 1 + 1;  // both ways; validity, depth, the history's length
    all.push_back(
        accumulation("svgf_accumulate", 6 + statistics, kSignal + kGuides + luminance + statistics + kTracePlanes));
  }
  if (values.find("variance")->second == from_picture)
    all.push_back({"svgf_variance_spatial", 1, 3,
                   48 * (kGeometry + kChord + kLevelWeightFlops + 2 + 2 * 6) + 40, 4 + 2 + 2});
  else
    all.push_back(
        {"svgf_variance_samples", 1, 3, 48 * (kGeometry + kChord + kLevelWeightFlops + 6) + 20, 4 + 2 + 2});
  append_levels(all,
                {.kernel = "svgf_level",
                 .flops = 24 * (kGeometry + kChord + 2 * kLightTap) + 2 * (9 * 4 + 20) + 20,
                 .floats = kFloats},
                static_cast<int>(values.find("levels")->second));
  // It makes the picture, of emission and albedo too.
  all.back().kernel = "svgf_last_level";
  all.back().flops += 3 * 3;
  all.back().floats += 3 + 3 + 3 - 8;
  append_taa_pass(all, values);
  return all;
}

}  // namespace

FilterDescription describe_svgf() {
  return {.name = "svgf",
          .summary =
              "five variance-guided a-trous levels; direct and indirect light apart; accumulates over frames",
          .source = "C. Schied et al.: Spatiotemporal Variance-Guided Filtering, HPG 2017",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          .scratch =
              [](const ParameterValues& values) {
                return 4.0 + with_history(values) + 2 * 8 + taa_scratch(values);
              },
          .history = history};
}

}  // namespace tessera
