// SPDX-License-Identifier: Apache-2.0
// SURE-based filtering of Li, Wu and Chuang 2012 (SBF): of a bank of cross-bilateral filters the one whose
// estimated error is least, pixel by pixel.
#include <cmath>

#include "core/filter/descriptions.h"

namespace tessera {
namespace {

constexpr std::string_view kProgram = "Li et al. 2012, published implementation";

std::vector<Parameter> parameters() {
  return {
      {"filters",
       "size of the bank: spatial sigmas 1, sqrt 2, 2, 2 sqrt 2, ... pixels, each reaching two sigmas", "",
       kProgram, 1, 7, 7, true},
      {"sigma_n", "difference of normals that stops the filter, in their standard deviations", "1", kProgram,
       1e-3, 1e3, 0.8},
      {"sigma_a", "difference of albedos that stops the filter, in their standard deviations", "1", kProgram,
       1e-3, 1e3, 0.25},
      {"sigma_d", "difference of depths that stops the filter, in their standard deviations", "1", kProgram,
       1e-3, 1e3, 0.6},
      {"diameter",
       "the depth that counts as 1; 0: the scene's diameter",
       "world units",
       "ours: the published implementation divides by the picture's largest depth, which no tile knows",
       0,
       1e30,
       0,
       false,
       {},
       SceneFact::diameter},
      {"smoothing", "spatial sigma of the filter that smooths the estimated errors", "pixels",
       "Li et al. 2012, published implementation (last iteration)", 0.5, 8, 8},
      {"unfiltered",
       "whether the noisy picture is one of the candidates, so that what has converged is left alone",
       "",
       "no: Li et al. 2012; yes: ours",
       0,
       1,
       0,
       true,
       {"no", "yes"}},
  };
}

std::vector<Channel> inputs(const ParameterValues&) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::albedo, Aov::normal, Aov::depth});
  append(all, {Aov::color, Aov::albedo, Aov::normal, Aov::depth}, Statistic::variance_of_mean);
  return all;
}

// Two sigmas of filter k of the bank.
int radius_of(int k) { return static_cast<int>(std::ceil(2 * std::pow(2.0, k / 2.0))); }

std::vector<Pass> passes(const ParameterValues& values) {
  constexpr double kWeight = 3 * 3 + 7 * 2 + 3 * 2 + 10 + 8 + kExpFlops;  // variances, squares, sum, quotient
  const int filters = static_cast<int>(values.find("filters")->second);
  const int smoothing = static_cast<int>(std::ceil(2 * values.find("smoothing")->second));
  const auto taps = [](int radius) { return std::pow(2 * radius + 1, 2) - 1; };
  double sums = 0;
  for (int k = 0; k < filters; ++k) sums += 8 * taps(radius_of(k)) + 20;
  return {
      {"sbf_bank", 1, radius_of(filters - 1), taps(radius_of(filters - 1)) * (kWeight + 3) + sums,
       10 + 6 + 4.0 * filters},
      {"sbf_select", 1, smoothing, taps(smoothing) * (kWeight + 1 + 2.0 * filters), 10 + 4.0 * filters + 9}};
}

double scratch(const ParameterValues& values) {
  return 10 + 6 + 4 * values.find("filters")->second + 1 + 1;  // and the spatial weights
}

}  // namespace

FilterDescription describe_sbf() {
  return {.name = "sbf",
          .summary = "of seven cross-bilateral filters, at each pixel the one of least estimated error",
          .source =
              "T.-M. Li, Y.-T. Wu, Y.-Y. Chuang: SURE-based Optimization for Adaptive Sampling and"
              " Reconstruction, ACM TOG 31(6), 2012",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          .scratch = scratch};
}

}  // namespace tessera
