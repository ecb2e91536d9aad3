// SPDX-License-Identifier: Apache-2.0
// The Data Driven Filter of van de Vlasakker 2013: a window without a spatial term, whose edge stops give way
// to the features' variance within the pixel.
#include "core/filter/descriptions.h"

namespace tessera {
namespace {

constexpr std::string_view kChosen = "van de Vlasakker 2013, equation 6.10 and table 7.2";

Parameter sigma(std::string_view name, std::string_view meaning, std::string_view unit, double standard) {
  return {name, meaning, unit, kChosen, 0.01, 1e4, standard};
}
Parameter scale(std::string_view name, std::string_view meaning, std::string_view unit) {
  return {name, meaning, unit, "van de Vlasakker 2013, equation 6.10 (s_f); the values it used are not given",
          0,    1e6,     1};
}

std::vector<Parameter> parameters() {
  return {
      window_parameter("kw", 21, "van de Vlasakker 2013, table 7.2"),
      {"sigma_dc", "standard deviation of direct light (RGB distance)", "radiance",
       "van de Vlasakker 2013, equation 6.8 and table 7.2", 0.01, 1e4, 0.75},
      {"sigma_ic", "standard deviation of indirect light (RGB distance)", "radiance",
       "van de Vlasakker 2013, equation 6.9 and table 7.2", 0.01, 1e4, 0.5},
      sigma("sigma_depth", "standard deviation of depth", "tenths of the scene's diameter", 1.75),
      sigma("sigma_normal", "standard deviation of the distance of normals", "1", 0.25),
      sigma("sigma_texture", "standard deviation of albedo (RGB distance)", "1", 0.1),
      sigma("sigma_direction", "of the direction after the first hit: see direction", "1", 0.75),
      sigma("sigma_texture2", "standard deviation of the albedo seen through mirrors and glass", "1", 0.1),
      scale("s_depth", "how fast variance in depth does away with its stop",
            "1 / squared tenths of the scene's diameter"),
      scale("s_normal", "how fast variance of normals does away with their stop", "1"),
      scale("s_texture", "how fast variance of albedo does away with its stop", "1"),
      scale("s_direction", "how fast variance of directions does away with their stop", "1"),
      scale("s_texture2", "how fast variance of texture2 does away with its stop", "1"),
      choice_parameter(
          "direction",
          "whose indirect light the stop of directions weighs down: everybody's, which changes nothing, "
          "or the"
          " neighbours' only, so that the less directions vary the less is filtered",
          "van de Vlasakker 2013, equation 6.14, as printed or as its text wants it",
          {"literal", "neighbours"}),
      choice_parameter("holes", "whether every second row and column of the window is left out",
                       "van de Vlasakker 2013, section 6.3.3", {"off", "on"}),
      choice_parameter(
          "progressive",
          "whether the variances of light shrink with the samples, being the paper's at 8 of them",
          "the paper's filter does not converge; 8 samples: van de Vlasakker 2013, chapter 7", {"off", "on"}),
      diameter_parameter(),
  };
}

bool on(const ParameterValues& values, std::string_view name) { return values.find(name)->second != 0; }

std::vector<Channel> inputs(const ParameterValues& values) {
  std::vector<Channel> all;
  append(all,
         {Aov::direct, Aov::indirect, Aov::emission, Aov::depth, Aov::normal, Aov::albedo, Aov::texture2});
  append(all, {Aov::depth, Aov::normal, Aov::albedo, Aov::texture2}, Statistic::variance_of_mean);
  if (on(values, "direction")) append(all, {Aov::bounce}, Statistic::variance_of_mean);
  all.push_back(kSampleCount);
  return all;
}

double planes(const ParameterValues& values) {
  return 20 + on(values, "direction") + on(values, "progressive");
}

// With holes the offsets are even, so that an odd radius reaches one pixel less far.
std::vector<Pass> passes(const ParameterValues& values) {
  const int step = on(values, "holes") ? 2 : 1, radius = window_radius(values, "kw") / step * step;
  const double taps = (2 * radius / step + 1) * (2 * radius / step + 1);
  const double light = 3 * 3 + kWeightFlops + 1 + 6 + 2 * on(values, "progressive");  // squares, weight, sums
  return {{"ddf", step, radius, taps * (10 * 4 + 2 * light) + 40, planes(values) + 9 + 3}};
}

}  // namespace

FilterDescription describe_ddf() {
  return {
      .name = "ddf",
      .summary =
          "a window steered by features, whose variance makes it blind to them; direct and indirect light"
          " apart",
      .source =
          "M. van de Vlasakker: Physically Accurate Noise Free Real-time Rendering, Utrecht University 2013",
      .parameters = parameters(),
      .inputs = inputs,
      .passes = passes,
      .scratch = [](const ParameterValues& v) { return window_scratch(static_cast<int>(planes(v))); }};
}

}  // namespace tessera
