// SPDX-License-Identifier: Apache-2.0
// The statistical denoiser of Sakai et al. 2024: a joint bilateral filter from which a test of equal means
// keeps the pixels that are certain to be different.
#include "core/filter/descriptions.h"

namespace tessera {
namespace {

std::vector<Parameter> parameters() {
  return {
      {"radius", "of the disc of pixels that are looked at", "pixels",
       "Sakai et al. 2024, published implementation", 1, 32, 20, true},
      {"sigma_s", "standard deviation of the spatial weight", "pixels",
       "Sakai et al. 2024, published implementation", 0.5, 100, 10},
      {"sigma_a", "standard deviation of the weight by albedo", "1",
       "Sakai et al. 2024, published implementation", 1e-3, 1e3, 0.02},
      {"sigma_n", "standard deviation of the weight by normal", "1",
       "Sakai et al. 2024, published implementation", 1e-3, 1e3, 0.1},
      {"level", "significance at which two pixels of equal mean are held for different", "1",
       "Sakai et al. 2024, section 5", 1e-6, 0.5, 0.005},
  };
}

std::vector<Channel> inputs(const ParameterValues&) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::albedo, Aov::normal, Aov::depth, Aov::box_cox});
  append(all, {Aov::box_cox}, Statistic::variance_of_mean);
  append(all, {Aov::box_cox}, Statistic::third_moment);
  all.push_back(kSampleCount);
  return all;
}

int disc(int radius) {
  int pixels = 0;
  for (int j = -radius; j <= radius; ++j)
    for (int i = -radius; i <= radius; ++i) pixels += i * i + j * j <= radius * radius;
  return pixels;
}

std::vector<Pass> passes(const ParameterValues& values) {
  constexpr double kTap =
      3 * 4 + 6 * 3 + kNumberFlops + 3 * 3 + 2;  // tests, guides, exponential, colour, sums
  const int radius = static_cast<int>(values.find("radius")->second);
  return {{.kernel = "statmc_gather",
           .radius = radius,
           .flops = (disc(radius) - 1) * kTap + 10,
           .floats = 6 + 6 + 3 + 3}};
}

}  // namespace

FilterDescription describe_statmc() {
  return {.name = "statmc",
          .summary = "joint bilateral filter over the pixels that no test of their samples tells apart",
          .source =
              "H. Sakai, C. Freude, T. Auzinger, D. Hahn, M. Wimmer: A Statistical Approach to Monte Carlo"
              " Denoising, SIGGRAPH Asia 2024",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          .scratch = [](const ParameterValues&) { return window_scratch(6 + 6 + 3); }};
}

}  // namespace tessera
