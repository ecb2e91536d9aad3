// SPDX-License-Identifier: Apache-2.0
#include "core/filter/taa.h"

#include <algorithm>

#include "core/filter/descriptions.h"

namespace tessera {

void append_taa_parameters(std::vector<Parameter>& to) {
  constexpr std::string_view source = "Karis 2014, High-quality Temporal Supersampling";
  to.push_back(choice_parameter(
      "taa",
      "whether the picture is mixed with the last frame's in the end, which steadies edges and is biased",
      source, {"off", "on"}));
  to.push_back({"taa_alpha", "share of the new picture in that mixture", "1",
                "Karis 2014; Koskela et al. 2019 take 0.2 in their program", 0.01, 1, 0.1});
  to.push_back(
      {"taa_gamma",
       "how far from the mean of the 3x3 pixels the old picture may be, in their standard deviations",
       "standard deviations", "Salvi 2016, An Excursion in Temporal Supersampling", 0.01, 100, 1});
}

bool with_taa(const ParameterValues& values) { return values.find("taa")->second == 1; }

void append_taa_inputs(std::vector<Channel>& to, const ParameterValues& values) {
  if (with_taa(values) && std::ranges::count(to, Channel{Aov::motion, 0}) == 0) append(to, {Aov::motion});
}

void append_taa_pass(std::vector<Pass>& to, const ParameterValues& values) {
  constexpr double kMotion = 9 * 4, kPlace = 12, kStatistics = 9 * (3 + 7 + 9) + 3 * 5, kHistory = 3 * 7 + 6;
  constexpr double kClip = 7 + 3 * 4 + 2 * 3, kMix = 2 * 5 + 8 + 2 * 3;
  if (with_taa(values))
    to.push_back({"taa", 1, 1, kMotion + kPlace + kStatistics + kHistory + kClip + kMix,
                  3 + 2 + kTaaPlanes + 3 + kTaaPlanes});
}

int taa_history(const ParameterValues& values) { return with_taa(values) ? kTaaPlanes : 0; }
double taa_scratch(const ParameterValues& values) { return with_taa(values) ? 3 : 0; }

}  // namespace tessera
