// SPDX-License-Identifier: Apache-2.0
// What is true of the SURE-based filter (Li, Wu and Chuang 2012).
#include <cmath>
#include <random>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class Sbf : public OnDevice {
 protected:
  // One plain surface under light of independent values of the given mean variance.
  static Image noise(const FilterPlan& plan, const Region& region, float variance, unsigned seed = 1) {
    Image input = made_up_input(plan, region, "constant");
    std::mt19937 random(seed);
    std::normal_distribution<float> deviate(0, 1);
    for (const Channel& c : plan.inputs()) {
      const int plane = plane_of(plan, c.aov, c.index, c.statistic);
      for (float& v : input.plane(plane))
        if (c.statistic != Statistic::mean)
          v = c.aov == Aov::color ? variance : 0;
        else
          v = c.aov == Aov::color ? 4 + deviate(random) : 0.5f;
    }
    return input;
  }
  // What the Gaussian of the given sigma, cut off at two sigmas, makes of a pixel in a plain picture.
  static double gaussian(const FilterPlan& plan, const Image& input, int channel, int x, int y,
                         double sigma) {
    const int radius = static_cast<int>(std::ceil(2 * sigma));
    double sum = 0, total = 0;
    for (int j = -radius; j <= radius; ++j)
      for (int i = -radius; i <= radius; ++i) {
        const double w = std::exp(-(i * i + j * j) / (2 * sigma * sigma));
        sum += w;
        total += w * input.at(plane_of(plan, Aov::color, channel), x + i, y + j);
      }
    return total / sum;
  }
  // The black one's of two pixels, one black and one white, whose `aov` differs by `distance` and has the
  // given variance: what it takes from the white one.
  double shared(Aov aov, double distance, double variance, std::string_view text) {
    const FilterPlan plan = parse_filter(text);
    Image input = noise(plan, {0, 0, 2, 1}, 1);
    for (int x = 0; x < 2; ++x) {
      for (int c = 0; c < 3; ++c) input.at(plane_of(plan, Aov::color, c), x, 0) = static_cast<float>(x);
      input.at(plane_of(plan, aov, 0), x, 0) = static_cast<float>(0.5 + x * distance);
      input.at(plane_of(plan, aov, 0, Statistic::variance_of_mean), x, 0) = static_cast<float>(variance);
    }
    return filtered(plan, input).at(0, 0, 0);
  }
};

TEST_F(Sbf, TakesTheWidestFilterWhereThereIsNothingButNoise) {
  const FilterPlan plan = parse_filter("sbf");
  const Image input = noise(plan, {0, 0, 60, 60}, 1);
  const Image result = filtered(plan, input);
  for (const int x : {20, 31, 40})
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(result.at(c, x, 25), gaussian(plan, input, c, x, 25, 8), 1e-5) << x;
}

TEST_F(Sbf, TakesTheNarrowestFilterWhereThereIsNoNoise) {
  const FilterPlan plan = parse_filter("sbf");
  const Image input = noise(plan, {0, 0, 60, 60}, 0);
  const Image result = filtered(plan, input);
  for (const int x : {20, 31, 40})
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(result.at(c, x, 25), gaussian(plan, input, c, x, 25, 1), 1e-5) << x;
}

TEST_F(Sbf, TakesAFilterBetweenWhereThatIsBest) {
  // Waves of 22 pixels: the estimated errors of the bank, averaged over the picture, name the filter.
  const FilterPlan plan = parse_filter("sbf");
  Image input = noise(plan, {0, 0, 72, 72}, 1);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 72; ++y)
      for (int x = 0; x < 72; ++x)
        input.at(plane_of(plan, Aov::color, c), x, y) += static_cast<float>(2 * std::sin(0.2855 * x));
  const Image result = filtered(plan, input);
  int between = 0;
  for (int x = 30; x < 42; ++x) {
    int nearest = 0;
    for (int k = 1; k < 7; ++k) {
      const auto miss = [&](int f) {
        return std::abs(gaussian(plan, input, 1, x, 36, std::pow(2, f / 2.0)) - result.at(1, x, 36));
      };
      if (miss(k) < miss(nearest)) nearest = k;
    }
    between += nearest > 0 && nearest < 6;
  }
  EXPECT_EQ(between, 12);
}

TEST_F(Sbf, LeavesWhatHasConvergedAloneIfTheNoisyPictureIsACandidate) {
  const FilterPlan plan = parse_filter("sbf:unfiltered=yes");
  const Image input = noise(plan, {0, 0, 50, 40}, 0);
  const Image result = filtered(plan, input);
  for (int c = 0; c < 3; ++c)
    EXPECT_TRUE(std::ranges::equal(result.plane(c), input.plane(plane_of(plan, Aov::color, c))));
  EXPECT_FALSE(same_bits(filtered(parse_filter("sbf"), input), result));
}

TEST_F(Sbf, WeighsADifferenceOfFeaturesByItsSigmaAndVariance) {
  const auto expected = [](double exponent) {
    const double w = std::exp(-0.5 - exponent);  // the first filter's sigma is a pixel
    return w / (1 + w);
  };
  const auto exponent = [](double d, double sigma, double v) { return d * d / (2 * sigma * sigma * v); };
  const std::string_view text = "sbf:filters=1,diameter=10";
  EXPECT_NEAR(shared(Aov::albedo, 0, 0, text), expected(0), 1e-6);
  EXPECT_NEAR(shared(Aov::albedo, 0.03, 0, text), expected(exponent(0.03, 0.25, 0.01)), 1e-6);
  EXPECT_NEAR(shared(Aov::albedo, 0.2, 0.3, text), expected(exponent(0.2, 0.25, 0.6)), 1e-6);
  EXPECT_NEAR(shared(Aov::normal, 0.1, 0.004, text), expected(exponent(0.1, 0.8, 0.01)), 1e-6);
  EXPECT_NEAR(shared(Aov::normal, 0.1, 0.02, text), expected(exponent(0.1, 0.8, 0.04)), 1e-6);
  EXPECT_NEAR(shared(Aov::depth, 0.5, 0, text), expected(exponent(0.05, 0.6, 0.01)), 1e-6);
  EXPECT_NEAR(shared(Aov::depth, 2, 3, text), expected(exponent(0.2, 0.6, 0.06)), 1e-6);
}

TEST_F(Sbf, ReachesAsFarAsItsHaloSaysAndNoFarther) {
  // The least error decides: what a pixel at the far end of the halo adds to the errors is seldom seen. A
  // flash there is.
  for (const std::string_view text : {"sbf", "sbf:filters=3,smoothing=1.2"}) {
    const FilterPlan plan = parse_filter(text);
    const int halo = plan.halo(), edge = 2 * halo + 8, middle = halo + 4;
    const Image input = noise(plan, {0, 0, edge, edge}, 1);
    const Image before = filtered(plan, input);
    const auto seen = [&](int distance) {
      Image flash = input;
      for (int c = 0; c < 3; ++c) flash.at(plane_of(plan, Aov::color, c), middle + distance, middle) = 1e9f;
      const Image after = filtered(plan, flash);
      return after.at(1, middle, middle) != before.at(1, middle, middle);
    };
    EXPECT_TRUE(seen(halo)) << text;
    EXPECT_FALSE(seen(halo + 1)) << text;
  }
}

}  // namespace
}  // namespace tessera
