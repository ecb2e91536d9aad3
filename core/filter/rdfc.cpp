// SPDX-License-Identifier: Apache-2.0
// Robust denoising using feature and colour information (RDFC), Rousselle, Manzi and Zwicker 2013.
#include "core/filter/descriptions.h"

namespace tessera {
namespace {

constexpr double kBest = 0;  // a choice of `take`
constexpr int kPatch = 3;    // radius of the larger patches

std::vector<Parameter> parameters() {
  return {
      {"window", "radius of the window of the three filters; patches of radius 1 and 3", "pixels",
       "Rousselle et al. 2013, section 4 (r)", 1, 10, 10, true},
      {"k_c", "how far colours may be apart, in standard deviations; the third filter ignores them", "1",
       "Rousselle et al. 2013, section 4 (k_c)", 0.01, 100, 0.45},
      {"k_f", "how far features may be apart, in standard deviations", "1",
       "Rousselle et al. 2013, section 4 (k_f)", 0.01, 100, 0.6},
      {"tau", "least variance of a feature, in the first two filters", "of features from 0 to 1",
       "Rousselle et al. 2013, equation 4 (tau)", 1e-8, 1, 1e-3},
      {"tau_features", "least variance of a feature, in the third filter", "of features from 0 to 1",
       "Rousselle et al. 2013, section 4 (tau of the filter of features alone)", 1e-8, 1, 1e-4},
      {.name = "depth_scale",
       .meaning = "the depth that counts as 1; 0: the scene's diameter",
       .unit = "world units",
       .source = "Rousselle et al. 2013, section 4.1: features from 0 to 1",
       .low = 0,
       .high = 1e12,
       .standard = 0,
       .fact = SceneFact::diameter},
      {"take",
       "the best of the three filters at each pixel, or one of them everywhere",
       "",
       "Rousselle et al. 2013, section 5",
       kBest,
       3,
       kBest,
       true,
       {"best", "small_patches", "large_patches", "features"}},
  };
}

std::vector<Channel> inputs(const ParameterValues&) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::albedo, Aov::normal, Aov::depth});
  append(all, {Aov::color, Aov::albedo, Aov::normal, Aov::depth}, Statistic::variance_of_mean);
  for (const Share half : {Share::a, Share::b}) {
    append(all, {Aov::albedo, Aov::normal, Aov::depth}, Statistic::mean, half);
    all.push_back({Aov::color, 0, Statistic::samples, half});
  }
  return all;
}

constexpr double square(double v) { return v * v; }

// The radius of a pass is how far it reads what the one before computed. Patches reach kPatch further, but
// only into the input, of which more is there than that: the prefilter's patches add up last.
std::vector<Pass> passes(const ParameterValues& values) {
  constexpr double kChannel = 11;            // a channel's part in the distance of two pixels
  constexpr double kPatchSums = 6 + 6 + 2;   // by rows and columns, and the mean
  constexpr double kWeight = 3 + kExpFlops;  // from a distance
  constexpr double kFeatures = 7 * (1 + 4 + 4) + 6;
  constexpr double kTaken =
      1 + kWeight + 3 + 4 + 3 * 6;  // by a filter that takes colours, and its derivative
  constexpr double kCandidates =
      3 * kChannel + 2 + 2 + kPatchSums + 2 + 3 + 3 * 4 + kFeatures + 2 * kTaken + kWeight + 1 + 6;
  constexpr double kSmooth = 3 * kChannel + kPatchSums + kWeight + 1;
  const int window = static_cast<int>(values.find("window")->second);
  std::vector<Pass> all{
      {"rdfc_features", 1, 5 + kPatch, square(11) * (7 * kChannel + 3 * (kPatchSums + kWeight + 1) + 14 * 3),
       1 + 21 + 14},
      {"rdfc_candidates", 1, window, square(2 * window + 1) * kCandidates, 7 + 14 + 14 + 12},
  };
  if (values.find("take")->second == kBest) {
    all.push_back({"rdfc_errors", 1, 1, square(3) * (kSmooth + 3 * 3), 7 + 3 + 2});
    all.push_back({"rdfc_blend", 1, 5, square(11) * (kSmooth + 2 * 3), 7 + 2 + 9 + 3});
  }
  return all;
}

}  // namespace

FilterDescription describe_rdfc() {
  return {.name = "rdfc",
          .summary = "three non-local means filters by colour and features, the best of each pixel's",
          .source =
              "F. Rousselle, M. Manzi, M. Zwicker: Robust Denoising using Feature and Color Information,"
              " Pacific Graphics 2013",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          // Planes; of a chunk of 64 x 32 pixels two maps of 80 x 38, two of 64 x 38, and 40 of its own.
          .scratch = [](const ParameterValues&) { return 7.0 + 21 + 14 + 9 + 6 + 6 + 40; }};
}

}  // namespace tessera
