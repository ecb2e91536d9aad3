// SPDX-License-Identifier: Apache-2.0
// Nonlinearly weighted first-order regression (NFOR), Bitterli et al. 2016.
#include "core/filter/descriptions.h"

namespace tessera {
namespace {

constexpr int kPatch = 3;

std::vector<Parameter> parameters() {
  return {
      {"window", "radius of the windows in which planes are fitted, and of those that smooth the choice",
       "pixels", "Bitterli et al. 2016, section 5.2 (r)", 1, 9, 9, true},
      {"k_narrow", "how far colours may be apart in the first regression, in standard deviations", "1",
       "Bitterli et al. 2016, section 5.3 (k_c)", 0.01, 100, 0.5},
      {"k_wide", "how far colours may be apart in the second regression, in standard deviations", "1",
       "Bitterli et al. 2016, section 5.3 (k_c)", 0.01, 100, 1.0},
      {"k_final", "how far filtered colours may be apart in the last regression, in standard deviations", "1",
       "Bitterli et al. 2016, section 5.4", 0.01, 100, 1.0},
      {"ridge", "what is added to a column's variance, as a share of it", "1",
       "ours, for single precision: Bitterli et al. 2016 add nothing", 1e-4, 10, 1e-3},
      {.name = "depth_scale",
       .meaning = "the depth that counts as 1; 0: the scene's diameter",
       .unit = "world units",
       .source = "ours: a column's size matters only to what counts as no variation",
       .low = 0,
       .high = 1e12,
       .standard = 0,
       .fact = SceneFact::diameter},
  };
}

std::vector<Channel> inputs(const ParameterValues&) {
  std::vector<Channel> all;
  const auto take = [&](Statistic statistic, Share share) {
    append(all, {Aov::color, Aov::albedo, Aov::normal, Aov::depth}, statistic, share);
  };
  take(Statistic::mean, Share::all);
  take(Statistic::variance_of_mean, Share::all);
  for (const Share half : {Share::a, Share::b}) {
    take(Statistic::mean, half);
    all.push_back({Aov::color, 0, Statistic::samples, half});
  }
  return all;
}

constexpr double square(double v) { return v * v; }

// The radius of a pass is how far it reads what the one before computed. Patches reach further, but into the
// input, or what else is there; only the last fit's patches are of what the pass before computed. The last
// features lie within what the first ones reach.
std::vector<Pass> passes(const ParameterValues& values) {
  constexpr double kChannel = 11;  // a channel's part in the distance of two pixels
  constexpr double kPatches = 3 * kChannel + 14, kSmall = 3 * kChannel + 6, kWeight = 4 + kExpFlops;
  constexpr double kFeatures = 7 * kChannel + 3 * (14 + kWeight) + 7 * 3;
  constexpr double kFit = kPatches + kWeight + 7 + 2 + 18 + 90 + 3 * 21;
  constexpr double kGather = kPatches + kWeight + 7 + 3 * (2 + 18 + 2);
  constexpr double kSolve = 1500;
  const int window = static_cast<int>(values.find("window")->second);
  const double taps = square(2 * window + 1);
  return {
      {"nfor_features", 1, 5 + kPatch, (2 * square(11) + square(5)) * kFeatures, 3 * (7 + 7 + 7 + 7)},
      {"nfor_fit", 1, window, 4 * (taps * kFit + kSolve), 4 * (1 + 3 + 3 + 7 + 3 + 30)},
      {"nfor_gather", 1, window, 4 * taps * kGather, 4 * (1 + 3 + 3 + 7 + 3 + 30 + 3)},
      {"nfor_compare", 1, window, taps * (kSmall + kWeight + 6), 7 + 2 + 1},
      {"nfor_blend", 1, window, taps * (kSmall + kWeight + 3), 7 + 1 + 12 + 6},
      {"nfor_fit", 1, window + kPatch, taps * kFit + kSolve, 1 + 3 + 3 + 7 + 30},
      {"nfor_gather", 1, window, taps * kGather, 1 + 3 + 3 + 7 + 30 + 3},
  };
}

}  // namespace

FilterDescription describe_nfor() {
  return {.name = "nfor",
          .summary = "planes in features fitted to the colours of windows, averaged where windows overlap",
          .source =
              "B. Bitterli et al.: Nonlinearly Weighted First-order Regression for Denoising Monte Carlo"
              " Renderings, EGSR 2016",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          // Planes; of a chunk of 64 x 32 pixels two maps of 80 x 38, two of 64 x 38, and 89 of its own.
          .scratch = [](const ParameterValues&) { return 7.0 + 9 + 21 + 14 + 12 + 30 + 3 + 6 + 89; }};
}

}  // namespace tessera
