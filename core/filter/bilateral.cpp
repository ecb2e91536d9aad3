// SPDX-License-Identifier: Apache-2.0
// Bilateral filters: Gaussians of the distance and of the difference in colour; the cross-bilateral one adds
// Gaussians of the differences in what the renderer knows of the surfaces. Both know no variance.
#include "core/filter/descriptions.h"

namespace tessera {
namespace {

constexpr std::string_view kThesis =
    "M. van de Vlasakker: Physically Accurate Noise Free Real-time Rendering, Utrecht University 2013";

std::vector<Parameter> parameters() {
  return {
      window_parameter("width", 21, "van de Vlasakker 2013, equation 3.6 (N_p)"),
      {"sigma_s", "standard deviation of the distance", "widths",
       "van de Vlasakker 2013, section 3.2.2 (width(N) / 4)", 0.01, 100, 0.25},
      {"sigma_r", "standard deviation of the difference in colour (RGB distance)", "radiance",
       "van de Vlasakker 2013, equation 3.6; the value is table 7.2's for direct light", 0.01, 1e4, 0.75},
  };
}

std::vector<Parameter> cross_parameters() {
  std::vector<Parameter> all = parameters();
  all.push_back({"sigma_n", "standard deviation of the distance of unit normals", "1",
                 "van de Vlasakker 2013, equation 3.9; the value is table 7.2's", 0.01, 1e4, 0.25});
  all.push_back({"sigma_d", "standard deviation of the depth", "tenths of the scene's diameter",
                 "van de Vlasakker 2013, equation 3.9; the value is table 7.2's", 0.01, 1e4, 1.75});
  all.push_back({"sigma_a", "standard deviation of the difference in albedo (RGB distance)", "1",
                 "van de Vlasakker 2013, section 6.2.1 (texture); the value is table 7.2's", 0.01, 1e4, 0.1});
  all.push_back(diameter_parameter());
  return all;
}

std::vector<Channel> inputs(const ParameterValues&) { return channels_of(Aov::color); }

std::vector<Channel> cross_inputs(const ParameterValues&) {
  std::vector<Channel> all = channels_of(Aov::color);
  append(all, {Aov::albedo, Aov::normal, Aov::depth});
  return all;
}

// `planes` of the colour and the features, all treated alike.
std::vector<Pass> passes(const ParameterValues& values, int planes) {
  const int radius = window_radius(values, "width"), taps = (2 * radius + 1) * (2 * radius + 1);
  const double tap = 3 * planes + 1 + kWeightFlops + 1 + 6;  // squares, distance, weight, sums
  return {{"bilateral", 1, radius, taps * tap + 8, planes + 3.0 + 3.0}};
}

}  // namespace

FilterDescription describe_bilateral() {
  return {.name = "bilateral",
          .summary = "a window steered by distance and colour",
          .source = kThesis,
          .parameters = parameters(),
          .inputs = inputs,
          .passes = [](const ParameterValues& v) { return passes(v, 3); },
          .scratch = [](const ParameterValues&) { return window_scratch(3); }};
}

FilterDescription describe_cross_bilateral() {
  return {.name = "cross-bilateral",
          .summary = "a window steered by distance, colour, normal, depth and albedo",
          .source = kThesis,
          .parameters = cross_parameters(),
          .inputs = cross_inputs,
          .passes = [](const ParameterValues& v) { return passes(v, 10); },
          .scratch = [](const ParameterValues&) { return window_scratch(10); }};
}

}  // namespace tessera
