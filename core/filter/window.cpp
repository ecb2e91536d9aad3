// SPDX-License-Identifier: Apache-2.0
// Square windows about a pixel, in the parameters of filters.
#include <array>

#include "core/filter/descriptions.h"

namespace tessera {
namespace {

// Odd, for the pixel is the centre.
constexpr std::array<std::string_view, 27> kWidths{"3",  "5",  "7",  "9",  "11", "13", "15", "17", "19",
                                                   "21", "23", "25", "27", "29", "31", "33", "35", "37",
                                                   "39", "41", "43", "45", "47", "49", "51", "53", "55"};

}  // namespace

Parameter window_parameter(std::string_view name, int standard, std::string_view source) {
  return {
      name, "width and height of the window", "pixels", source, 0, kWidths.size() - 1, (standard - 3) / 2.0,
      true, {kWidths.begin(), kWidths.end()}};
}

int window_radius(const ParameterValues& values, std::string_view name) {
  return static_cast<int>(values.find(name)->second) + 1;
}

// A strip's row has 160 floats for a radius up to 16, 192 beyond; a row of the narrowest plane 48 up to 15,
// 80 beyond.
double window_scratch(int planes) { return 160.0 / 48 * planes; }

Parameter diameter_parameter() {
  return {.name = "diameter",
          .meaning = "the scene's diameter, a tenth of which is the unit of depth; 0: that of the scene",
          .unit = "world units",
          .source = "van de Vlasakker 2013 measures depth in the units of each scene; here it fits any scale",
          .low = 0,
          .high = 1e30,
          .standard = 0,
          .fact = SceneFact::diameter};
}

}  // namespace tessera
