// SPDX-License-Identifier: Apache-2.0
// The Feature Distance Filter of M. Lardinoije's thesis: a bilateral filter by albedo, normal and the light
// that reaches a pixel, the last smoothed by non-local means. The colour steers nothing.
#include "core/filter/descriptions.h"
#include "core/filter/nlm.h"
#include "core/filter/pairs.h"

namespace tessera {
namespace {

constexpr double raw = 0, prefiltered = 1;  // choices of `guides`
constexpr std::string_view kSource = "Lardinoije, section 4.2";

std::vector<Parameter> parameters() {
  return {
      {"radius", "of the window", "pixels", kSource, 1, 16, 8, true},
      {"t_max", "albedo difference that stops the filter", "1", kSource, 1e-4, 10, 0.03},
      {"n_max", "difference of normals, mapped to 0..1, that stops the filter", "1", kSource, 1e-4, 10, 0.06},
      {"s_max", "shading difference that stops the filter at one sample; n samples, that over n",
       "of the emitters' luminance", kSource, 1e-3, 1e4, 5},
      {"light",
       "luminance by which shading is divided, so that s_max does not depend on exposure; 0: the mean of what"
       " emits in the scene",
       "radiance",
       "the source's scenes are lit by emitters of the order of 1",
       0,
       1e9,
       0,
       false,
       {},
       SceneFact::light},
      {"prefilter_radius", "of the window in which the shading is smoothed", "pixels", kSource, 1, 10, 5,
       true},
      {"prefilter_patch", "radius of the patches by which the shading is smoothed", "pixels", kSource, 1, 4,
       2, true},
      {"epsilon", "variance that the prefilter takes every pixel to have at least", "1", kSource, 1e-12, 1,
       1e-10},
      {"guides",
       "albedo and normals as they are, or smoothed like the shading: for depth of field and motion blur, "
       "under"
       " which they are noisy",
       "",
       "Lardinoije, section 4.2, takes them to be free of noise",
       raw,
       prefiltered,
       raw,
       true,
       {"raw", "prefiltered"}},
  };
}

bool smooths_guides(const ParameterValues& v) { return v.find("guides")->second == prefiltered; }

std::vector<Channel> inputs(const ParameterValues& v) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::albedo, Aov::normal, Aov::depth, Aov::shading});
  append(all, {Aov::shading}, Statistic::variance_of_mean);
  if (smooths_guides(v)) append(all, {Aov::albedo, Aov::normal}, Statistic::variance_of_mean);
  all.push_back(kSampleCount);
  return all;
}

std::vector<Pass> passes(const ParameterValues& v) {
  const NlmShape shape = fdf_prefilter_shape(v);
  const int radius = static_cast<int>(v.find("radius")->second), images = smooths_guides(v) ? 7 : 1;
  const double taps = (2.0 * radius + 1) * (2.0 * radius + 1) - 1;
  // Differences, magnitudes, maxima, scales, of which each serves two taps; sums.
  constexpr double kTap = 0.5 * (7 + 7 + 7 + 4 + kNumberFlops) + 1 + 3 * 3;
  return {{"nlm_mean_of_exp", 1, shape.reach(), images * nlm_mean_of_exp_flops(shape), 1.0 + images * 3},
          {"fdf_filter", 1, radius, taps * kTap, 9 + 3 + 3}};
}

double scratch(const ParameterValues& v) {
  const double tile = pair_floats({static_cast<int>(v.find("radius")->second)}, kPairColumns, kPairRows, 16);
  return 1 + 8 + 3 + 3 + (smooths_guides(v) ? 14 : 2) + nlm_scratch(fdf_prefilter_shape(v)) +
         kUneven * tile / (kPairColumns * kPairRows);
}

}  // namespace

NlmShape fdf_prefilter_shape(const ParameterValues& v) {
  return {.radius = static_cast<int>(v.find("prefilter_radius")->second),
          .patch = static_cast<int>(v.find("prefilter_patch")->second)};
}

FilterDescription describe_fdf() {
  return {.name = "fdf",
          .summary = "bilateral by albedo, normal and smoothed shading, the most different of which decides",
          .source = "M. Lardinoije: High-quality interactive path tracing, MSc thesis, Utrecht University",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          .scratch = scratch};
}

}  // namespace tessera
