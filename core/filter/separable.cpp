// SPDX-License-Identifier: Apache-2.0
// Filters that see nothing but distance, so that rows and columns can be summed one after the other: the mean
// of a window and the Gaussian blur. The plainest of all baselines.
#include <cmath>

#include "core/filter/descriptions.h"

namespace tessera {
namespace {

constexpr std::string_view kThesis =
    "M. van de Vlasakker: Physically Accurate Noise Free Real-time Rendering, Utrecht University 2013";

std::vector<Channel> inputs(const ParameterValues&) { return channels_of(Aov::color); }

// Rows are read sideways only and columns up and down only, so that the two reach no farther than one does.
std::vector<Pass> passes(int radius) {
  const double tap = 2 + 3 + 6;  // weight, differences, sums
  const double flops = (2 * radius + 1) * tap + 8;
  return {{"rows", 1, 0, flops, 4 + 4}, {"columns", 1, radius, flops, 4 + 4 + 3 + 3}};
}

double scratch(const ParameterValues&) { return 2 * 4.0; }

}  // namespace

FilterDescription describe_box() {
  return {.name = "box",
          .summary = "the mean of all pixels in a window",
          .source = kThesis,
          .parameters = {window_parameter("width", 3, "van de Vlasakker 2013, section 3.1.1")},
          .inputs = inputs,
          .passes = [](const ParameterValues& v) { return passes(window_radius(v, "width")); },
          .scratch = scratch};
}

FilterDescription describe_gaussian() {
  return {.name = "gaussian",
          .summary = "Gaussian blur, cut off at three sigma",
          .source = kThesis,
          .parameters = {{"sigma", "standard deviation of the Gaussian; the window reaches three of them far",
                          "pixels", "van de Vlasakker 2013, equations 3.2 and 3.3", 0.1, 9, 2}},
          .inputs = inputs,
          .passes =
              [](const ParameterValues& v) {
                return passes(static_cast<int>(std::ceil(3 * v.find("sigma")->second)));
              },
          .scratch = scratch};
}

}  // namespace tessera
