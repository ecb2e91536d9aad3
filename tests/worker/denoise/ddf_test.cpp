// SPDX-License-Identifier: Apache-2.0
// What is true of the Data Driven Filter by its formulas (van de Vlasakker 2013, section 6.2.3).
#include <cmath>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

constexpr Statistic kVariance = Statistic::variance_of_mean;

class Ddf : public OnDevice {
 protected:
  static void fill(Image& input, const FilterPlan& plan, Aov aov, float value,
                   Statistic statistic = Statistic::mean) {
    for (int c = 0; c < info(aov).channels; ++c)
      std::ranges::fill(input.plane(plane_of(plan, aov, c, statistic)), value);
  }
  static Image without_variance(const FilterPlan& plan, const Region& region) {
    Image input = made_up_input(plan, region, "noise");
    const std::vector<Channel> inputs = plan.inputs();
    for (int k = 0; k < input.planes(); ++k)
      if (inputs[k].statistic == kVariance) std::ranges::fill(input.plane(k), 0.0f);
    return input;
  }
  static FilterPlan with(std::string_view text) { return parse_filter("ddf:" + std::string(text)); }
};

const Region kRegion{0, 0, 60, 40};

TEST_F(Ddf, WeighsTheOnlyNeighbourByItsGaussians) {
  const FilterPlan plan = with("diameter=20");
  Image input = made_up_input(plan, {0, 0, 2, 1}, "constant");
  for (int k = 0; k < input.planes(); ++k)
    if (plan.inputs()[k].statistic != Statistic::samples) std::ranges::fill(input.plane(k), 0.0f);
  const auto set = [&](Aov aov, int c, float v) { input.at(plane_of(plan, aov, c), 1, 0) = v; };
  set(Aov::direct, 0, 0.3f);
  set(Aov::indirect, 1, 0.4f);
  set(Aov::depth, 0, 1);  // half a tenth of the diameter
  set(Aov::normal, 1, 0.2f);
  set(Aov::albedo, 2, 0.05f);
  set(Aov::texture2, 0, 0.08f);
  const auto gaussian = [](double d, double sigma) { return std::exp(-d * d / (2 * sigma * sigma)); };
  const double features = gaussian(0.5, 1.75) * gaussian(0.2, 0.25) * gaussian(0.05, 0.1);
  const double direct = features * gaussian(0.3, 0.75);
  const double indirect = features * gaussian(0.4, 0.5) * gaussian(0.08, 0.1);
  const Image result = filtered(plan, input);
  EXPECT_NEAR(result.at(0, 0, 0), 0.3 * direct / (1 + direct), 2e-5);
  EXPECT_NEAR(result.at(1, 0, 0), 0.4 * indirect / (1 + indirect), 2e-5);
}

TEST_F(Ddf, TakesTheDirectionLiterallyAsNothing) {
  const Image input = made_up_input(with("kw=11"), kRegion, "noise");
  EXPECT_TRUE(same_bits(filtered(with("kw=11,sigma_direction=0.01"), input), filtered(with("kw=11"), input)));
  EXPECT_TRUE(same_bits(filtered(with("kw=11,s_direction=100"), input), filtered(with("kw=11"), input)));
}

TEST_F(Ddf, FiltersIndirectLightOfMirrorsLessIfNeighboursCarryTheDirection) {
  const FilterPlan plan = with("kw=11,direction=neighbours,sigma_direction=0.1");
  Image input = made_up_input(plan, kRegion, "noise");
  fill(input, plan, Aov::direct, 0);
  fill(input, plan, Aov::emission, 0);
  fill(input, plan, Aov::bounce, 0, kVariance);  // exp(-50) of everybody else
  const Image mirror = filtered(plan, input);
  for (int c = 0; c < 3; ++c)
    EXPECT_TRUE(std::ranges::equal(mirror.plane(c), input.plane(plane_of(plan, Aov::indirect, c))));
  fill(input, plan, Aov::bounce, 1, kVariance);  // so wide that nothing is left of the stop
  const FilterPlan literal = with("kw=11");
  Image same = made_up_input(literal, kRegion, "noise");
  for (int k = 0; k < same.planes(); ++k) {
    const Channel c = literal.inputs()[k];
    std::ranges::copy(input.plane(plane_of(plan, c.aov, c.index, c.statistic)), same.plane(k).begin());
  }
  const Image rough = filtered(plan, input), expected = filtered(literal, same);
  for (std::size_t i = 0; i < rough.data().size(); ++i)
    ASSERT_NEAR(rough.data()[i], expected.data()[i], 1e-6) << i;
}

TEST_F(Ddf, WithHolesIsTheFilterOfAPictureOfHalfTheSize) {
  const FilterPlan whole = with("kw=11"), holes = with("kw=21,holes=on");
  EXPECT_EQ(whole.halo(), 5);
  EXPECT_EQ(holes.halo(), 10);
  EXPECT_EQ(with("kw=15,holes=on").halo(), 6);
  const Image small = made_up_input(whole, {0, 0, 40, 30}, "sky");
  Image large({0, 0, 80, 60}, small.planes());
  for (int k = 0; k < large.planes(); ++k)
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 80; ++x) large.at(k, x, y) = small.at(k, x / 2, y / 2);
  const Image expected = filtered(whole, small), result = filtered(holes, large);
  for (int k = 0; k < 3; ++k)
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 80; ++x) ASSERT_EQ(result.at(k, x, y), expected.at(k, x / 2, y / 2));
}

TEST_F(Ddf, IsBlindToAFeatureThatVariesWithinThePixel) {
  for (const auto& [aov, sigma] :
       {std::pair{Aov::depth, "sigma_depth"}, std::pair{Aov::normal, "sigma_normal"},
        std::pair{Aov::albedo, "sigma_texture"}, std::pair{Aov::texture2, "sigma_texture2"}}) {
    const FilterPlan plan = with("kw=11,diameter=10");
    Image input = without_variance(plan, kRegion);
    const Image blind = filtered(with("kw=11,diameter=10," + std::string(sigma) + "=10000"), input);
    const Image sees = filtered(plan, input);
    fill(input, plan, aov, 1, kVariance);  // of the mean; of a sample it is no less
    const Image result = filtered(plan, input);
    EXPECT_FALSE(same_bits(sees, result)) << sigma;
    for (std::size_t i = 0; i < result.data().size(); ++i)
      ASSERT_NEAR(result.data()[i], blind.data()[i], 1e-5) << sigma << ", value " << i;
  }
}

TEST_F(Ddf, CountsTheVarianceOfASampleNotOfTheMean) {
  const FilterPlan plan = with("kw=11");
  Image input = without_variance(plan, kRegion);
  const auto set = [&](float samples, float variance) {
    std::ranges::fill(input.plane(plane_of(plan, Aov::color, 0, Statistic::samples)), samples);
    fill(input, plan, Aov::albedo, variance, kVariance);
    return filtered(plan, input);
  };
  const Image expected = set(4, 0.0625f);
  EXPECT_TRUE(same_bits(set(64, 0.00390625f), expected));
  EXPECT_FALSE(same_bits(set(64, 0.0625f), expected));
}

TEST_F(Ddf, KeepsTheSkyOutWhereDepthStopsNothing) {
  const FilterPlan plan = with("kw=11");
  Image input = made_up_input(plan, kRegion, "sky"), other = input;
  fill(input, plan, Aov::depth, 1, kVariance);
  fill(other, plan, Aov::depth, 1, kVariance);
  const int depth = plane_of(plan, Aov::depth, 0), light = plane_of(plan, Aov::indirect, 0);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x)
      if (input.at(depth, x, y) == kSkyDepth) other.at(light, x, y) = 0.5f;
  const Image a = filtered(plan, input), b = filtered(plan, other);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x) {
      ASSERT_TRUE(std::isfinite(a.at(0, x, y)));
      if (input.at(depth, x, y) != kSkyDepth) {
        ASSERT_EQ(a.at(0, x, y), b.at(0, x, y));
      }
    }
}

TEST_F(Ddf, NarrowsWithTheSamplesIfItIsProgressive) {
  const FilterPlan plan = with("kw=11,progressive=on");
  Image input = without_variance(plan, kRegion);
  const auto of = [&](float samples, const FilterPlan& p) {
    std::ranges::fill(input.plane(plane_of(plan, Aov::color, 0, Statistic::samples)), samples);
    return filtered(p, input);
  };
  for (const auto& [samples, text] :
       {std::pair{8.0f, "kw=11"}, std::pair{32.0f, "kw=11,sigma_dc=0.375,sigma_ic=0.25"},
        std::pair{2.0f, "kw=11,sigma_dc=1.5,sigma_ic=1"}}) {
    const Image expected = of(samples, with(text)), result = of(samples, plan);
    for (std::size_t i = 0; i < result.data().size(); ++i)
      ASSERT_NEAR(result.data()[i], expected.data()[i], 1e-5) << samples << " samples, value " << i;
  }
}

TEST_F(Ddf, FitsAnyScaleOfTheScene) {
  const FilterPlan plan = with("kw=11,sigma_depth=0.2");
  Image input = made_up_input(plan, kRegion, "noise");
  const Image expected = filtered(resolved(plan, {.diameter = 16}), input);
  for (float& v : input.plane(plane_of(plan, Aov::depth, 0))) v *= 64;
  for (float& v : input.plane(plane_of(plan, Aov::depth, 0, kVariance))) v *= 64 * 64;
  EXPECT_TRUE(same_bits(filtered(resolved(plan, {.diameter = 1024}), input), expected));
}

TEST_F(Ddf, AddsEmissionUnfiltered) {
  const FilterPlan plan = with("kw=11");
  Image input = made_up_input(plan, kRegion, "noise");
  fill(input, plan, Aov::emission, 0);
  Image expected = filtered(plan, input);
  input.at(plane_of(plan, Aov::emission, 1), 20, 20) = 1000;
  expected.at(1, 20, 20) += 1000;
  EXPECT_TRUE(same_bits(filtered(plan, input), expected));
}

}  // namespace
}  // namespace tessera
