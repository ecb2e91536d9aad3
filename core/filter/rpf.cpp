// SPDX-License-Identifier: Apache-2.0
// Random Parameter Filtering of Sen and Darabi 2012, as read by van de Vlasakker 2013: what parts of a colour
// depend on the renderer's random numbers is found by mutual information, and smoothed.
#include "core/filter/rpf.h"

#include <algorithm>

#include "core/filter/descriptions.h"

namespace tessera {
namespace {

std::vector<Parameter> parameters() {
  std::vector<Parameter> all{
      {"preset",
       "constants of the paper, or of the program that its authors released in 2015",
       "",
       "Sen and Darabi 2012; their release of 2015",
       0,
       1,
       0,
       true,
       {"paper", "release2015"}},
      {"sigma8",
       "variance of the noise at 8 samples a pixel; 0: the preset's, 0.02 or 0.05. 0.002 suits scenes with "
       "little noise",
       "1", "van de Vlasakker 2013, equation 5.17", 0, 10, 0},
  };
  for (const std::string_view name : kRpfBoxes)
    all.push_back({name,
                   "edge of the box that an iteration draws from; 0: the preset's, 55 35 17 7 or 45 30 15 5",
                   "pixels", "van de Vlasakker 2013, section 5.1.2", 0, 63, 0, true});
  const std::vector<Parameter> rest{
      {"draws", "share of the neighbours that are drawn", "1", "1 is van de Vlasakker 2013, section 5.1.2",
       1e-3, 1, 1},
      {"buckets",
       "of histograms, one a standard deviation",
       "1",
       "open in van de Vlasakker 2013, algorithm 7; 11 hold five deviations on each side",
       0,
       6,
       4,
       true,
       {"3", "5", "7", "9", "11", "13", "15"}},
      {"second_hit",
       "whether the path went on to another surface: a feature of its own, or not",
       "",
       "plain is van de Vlasakker 2013, table 5.1; there, no second hit is one at the origin",
       0,
       1,
       1,
       true,
       {"plain", "flagged"}},
      {.name = "diameter",
       .meaning = "positions that differ by less than a tenth of it are never told apart",
       .unit = "world units",
       .source = "the paper's 0.1 has no unit; van de Vlasakker 2013, section 5.2.2, finds that it matters",
       .low = 0,
       .high = 1e30,
       .standard = 0,
       .fact = SceneFact::diameter},
      {"seed", "of the random draws", "", "any number is as good as another", 0, 4294967295.0, 0, true},
  };
  all.insert(all.end(), rest.begin(), rest.end());
  return all;
}

std::vector<Channel> inputs(const ParameterValues&) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::depth});
  append(all, {Aov::sample_vectors}, Statistic::mean, Share::a);
  append(all, {Aov::sample_vectors}, Statistic::mean, Share::b);
  return all;
}

// Operations where no draw is refused: for each neighbour 19 terms of 8 samples, each with a weight and three
// sums; beside that, its draw, its test, its statistics and its buckets.
std::vector<Pass> passes(const ParameterValues& values) {
  constexpr double kSamples = 8, kTerms = 19, kNumbers = 27;
  constexpr double kNeighbour = kSamples * (4 * kTerms + kExpFlops + 3 * 3 + 1) + 16 * 2 + kNumbers * (4 + 4);
  std::vector<Pass> all;
  for (int t = 0; t < kRpfIterations; ++t) {
    const RpfIteration i = rpf_iteration(values, t);
    all.push_back({"rpf_filter", 1, i.radius, i.draws * kSamples * kNeighbour, 8 * 32 + 2 * 24});
  }
  return all;
}

}  // namespace

RpfIteration rpf_iteration(const ParameterValues& values, int t) {
  constexpr int kPaper[kRpfIterations] = {55, 35, 17, 7}, kRelease[kRpfIterations] = {45, 30, 15, 5};
  const auto value = [&](std::string_view name) { return values.find(name)->second; };
  const bool release = value("preset") == 1;
  const double asked = value(kRpfBoxes[t]);
  const double box = asked > 0 ? asked : release ? kRelease[t] : kPaper[t];
  RpfIteration i;
  i.radius = static_cast<int>(box) / 2;
  i.deviation = release ? std::max(1.0, (box - 1) / 4) : box / 4;
  i.draws = value("draws") * box * box / (release && t < 2 ? 3 : 2);
  i.dependence = release ? 0.3 + 0.05 * t : 1 + 0.1 * t;
  return i;
}

RpfConstants rpf_constants(const ParameterValues& values) {
  const auto value = [&](std::string_view name) { return values.find(name)->second; };
  RpfConstants c;
  if (value("preset") == 1)
    c = {.position = 50,
         .color_factor = 4,
         .texture_factor = 25,
         .normal_factor = 10,
         .variance = 8 * 0.05,
         .brightest = 10,
         .spikes = true};
  if (value("sigma8") > 0) c.variance = 8 * value("sigma8");
  c.position_guard = c.guard * value("diameter");
  c.buckets = 3 + 2 * static_cast<int>(value("buckets"));
  return c;
}

FilterDescription describe_rpf() {
  return {
      .name = "rpf",
      .summary = "means of alike samples drawn around each sample; smooths what depends on random numbers",
      .source =
          "P. Sen, S. Darabi: On Filtering the Noise from the Random Parameters in Monte Carlo "
          "Rendering, TOG 2012, as read by M. van de Vlasakker, Utrecht 2013",
      .parameters = parameters(),
      .inputs = inputs,
      .passes = passes,
      .scratch = [](const ParameterValues&) { return 8.0 * 32 + 24 + 1; }};
}

}  // namespace tessera
