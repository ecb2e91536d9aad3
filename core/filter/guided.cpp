// SPDX-License-Identifier: Apache-2.0
// The guided image filter on illumination, guided by normals and depth, as Bauszat et al. 2011 use it.
#include "core/filter/descriptions.h"

namespace tessera {
namespace {

// Of a pixel: 1, guidance, its squares and products, illumination, its products with the guidance; then the
// fit's slopes and constant.
constexpr int kMoments = 1 + 4 + 10 + 3 + 12, kFit = 12 + 3;

std::vector<Parameter> parameters() {
  return {
      {"radius",
       "of the square window in which illumination is fitted, and of that in which fits are averaged",
       "pixels", "Bauszat et al. 2011, section 4 (24 for indirect, 12 for direct light)", 1, 64, 24, true},
      {"epsilon", "added to the variances of the guidance: what varies less does not show", "1",
       "Bauszat et al. 2011, section 3 (epsilon); He et al. 2010, equation 5", 1e-6, 1e6, 0.01},
      {.name = "depth_scale",
       .meaning = "depth that counts as much as a unit of the normal; 0: the scene's diameter",
       .unit = "world units",
       .source = "Bauszat et al. 2011, section 4 (depth of the order of 1)",
       .low = 0,
       .high = 1e12,
       .standard = 0,
       .fact = SceneFact::diameter},
  };
}

std::vector<Channel> inputs(const ParameterValues&) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::emission, Aov::albedo, Aov::normal, Aov::depth});
  return all;
}

std::vector<Pass> passes(const ParameterValues& values) {
  const int radius = static_cast<int>(values.find("radius")->second);
  const double taps = 2 * radius + 1;
  constexpr double kSolve = 2 * 14 + 10 * 2 + 4 * 9 + 3 * 32 + 3 * 8;  // covariances, factors, solutions
  return {
      {"guided_moments", 1, 0, taps * (1 + 4 + 2 * 10 + 3 + 2 * 12), 8 + kMoments},
      {"guided_fit", 1, radius, taps * kMoments + kSolve, kMoments + kFit + 1},
      {"guided_rows", 1, 0, taps * kFit, 2 * kFit},
      {"guided_apply", 1, radius, taps * kFit + 3 * 11, kFit + 8 + 1 + 9 + 3},
  };
}

}  // namespace

FilterDescription describe_guided() {
  return {.name = "guided",
          .summary = "in every window illumination as a linear function of normal and depth",
          .source =
              "P. Bauszat, M. Eisemann, M. Magnor: Guided Image Filtering for Interactive High-quality"
              " Global Illumination, EGSR 2011",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          .scratch = [](const ParameterValues&) { return 8.0 + kMoments + kFit + 1; }};
}

}  // namespace tessera
