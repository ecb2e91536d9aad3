// SPDX-License-Identifier: Apache-2.0
// What is true of box, gaussian, bilateral and cross-bilateral by their formulas.
#include <cmath>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class Baselines : public OnDevice {
 protected:
  static Image dark(const FilterPlan& plan, const Region& region) {
    Image input = made_up_input(plan, region, "constant");
    for (int c = 0; c < 3; ++c) std::ranges::fill(input.plane(plane_of(plan, Aov::color, c)), 0.0f);
    return input;
  }
  // Two pixels side by side, which only `aov` tells apart: how much of the second is in the first.
  double share_of_the_other(const FilterPlan& plan, Aov aov, float difference) {
    Image input = dark(plan, {0, 0, 2, 1});
    const auto set = [&](Aov a, int c, int x, float v) { input.at(plane_of(plan, a, c), x, 0) = v; };
    set(Aov::color, 1, 1, 1e-3f);  // what is measured; as a difference it weighs nothing
    if (aov == Aov::color) {
      set(aov, 2, 1, difference);
      return filtered(plan, input).at(2, 0, 0) / difference;
    }
    for (int x = 0; x < 2; ++x) {
      for (int c = 0; c < 3; ++c) set(Aov::normal, c, x, c == 2 ? 1.0f : 0.0f);
      set(Aov::depth, 0, x, 4);
    }
    if (aov == Aov::normal) {  // a chord of this length
      set(aov, 0, 1, difference * std::sqrt(1 - difference * difference / 4));
      set(aov, 2, 1, 1 - difference * difference / 2);
    } else {
      set(aov, 0, 1, input.at(plane_of(plan, aov, 0), 0, 0) + difference);
    }
    return filtered(plan, input).at(1, 0, 0) / 1e-3;
  }
};

TEST_F(Baselines, SpreadALitPixelByTheirWeights) {
  for (const auto& [text, radius, sigma] :
       {std::tuple{"box:width=7", 3, 1e9}, std::tuple{"gaussian:sigma=1.5", 5, 1.5}}) {
    const FilterPlan plan = parse_filter(text);
    ASSERT_EQ(plan.halo(), radius);
    Image input = dark(plan, {-16, -16, 17, 17});
    input.at(1, 0, 0) = 3;
    const Image result = filtered(plan, input);
    double line = 0;
    for (int i = -radius; i <= radius; ++i) line += std::exp(-i * i / (2 * sigma * sigma));
    for (int y = -10; y <= 10; ++y)
      for (int x = -10; x <= 10; ++x) {
        const bool inside = std::max(std::abs(x), std::abs(y)) <= radius;
        const double expected =
            inside ? 3 * std::exp(-(x * x + y * y) / (2 * sigma * sigma)) / (line * line) : 0;
        ASSERT_NEAR(result.at(1, x, y), expected, 1e-6 * expected) << text << " at " << x << ", " << y;
      }
  }
}

TEST_F(Baselines, LeaveOutWhatIsBeyondTheFrameOrNotFinite) {
  const FilterPlan plan = parse_filter("box:width=5");
  Image input = dark(plan, {0, 0, 9, 9});
  input.at(0, 1, 1) = 18;
  EXPECT_FLOAT_EQ(filtered(plan, input).at(0, 0, 0), 2);  // 9 pixels are in the picture
  input.at(2, 2, 0) = NAN;
  EXPECT_FLOAT_EQ(filtered(plan, input).at(0, 0, 0), 18.0f / 8);
}

TEST_F(Baselines, AreTheGaussianBlurWhereTheColourStopsNothing) {
  // A window of 13 pixels reaches three sigma of 2 far. Weights of windows err by up to 9e-5.
  const FilterPlan gaussian = parse_filter("gaussian:sigma=2"),
                   bilateral = parse_filter("bilateral:width=13,sigma_s=0.15384615384615385,sigma_r=10000");
  const Image input = made_up_input(gaussian, {0, 0, 60, 40}, "noise");
  const Image expected = filtered(gaussian, input), result = filtered(bilateral, input);
  for (std::size_t i = 0; i < expected.data().size(); ++i)
    ASSERT_NEAR(result.data()[i], expected.data()[i], 5e-5) << i;
}

TEST_F(Baselines, KeepAnEdgeFarHigherThanTheNoise) {
  const FilterPlan plan = parse_filter("bilateral:sigma_r=0.1");
  Image input = dark(plan, {0, 0, 40, 30});
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 40; ++x) input.at(c, x, y) = x < 20 ? 1.0f : 9.0f;
  EXPECT_TRUE(same_bits(filtered(plan, input), input));
}

TEST_F(Baselines, WeighEveryDifferenceByItsGaussian) {
  const std::string flat = "sigma_s=100,sigma_r=10000,sigma_n=10000,sigma_d=10000,sigma_a=10000";
  const auto weighed = [&](const std::string& name, const std::string& value) {
    std::string text = flat;
    const std::size_t at = text.find(name);
    text.replace(at, text.find(',', at) - at, name + value);
    return parse_filter("cross-bilateral:diameter=20," + text);
  };
  const auto share = [](double difference, double sigma) {
    const double w = std::exp(-difference * difference / (2 * sigma * sigma));
    return w / (1 + w);
  };
  EXPECT_NEAR(share_of_the_other(weighed("sigma_r=", "0.5"), Aov::color, 0.7f), share(0.7, 0.5), 3e-5);
  EXPECT_NEAR(share_of_the_other(weighed("sigma_n=", "0.2"), Aov::normal, 0.3f), share(0.3, 0.2), 3e-5);
  EXPECT_NEAR(share_of_the_other(weighed("sigma_a=", "0.1"), Aov::albedo, 0.2f), share(0.2, 0.1), 3e-5);
  // Depth counts in tenths of the diameter: of 20, so that 1 is half of one.
  EXPECT_NEAR(share_of_the_other(weighed("sigma_d=", "0.4"), Aov::depth, 1.0f), share(0.5, 0.4), 3e-5);
}

TEST_F(Baselines, FitAnyScaleOfTheScene) {
  FilterPlan plan = parse_filter("cross-bilateral:sigma_d=0.1");
  Image input = made_up_input(plan, {0, 0, 50, 40}, "noise");
  const Image expected = filtered(resolved(plan, {.diameter = 16}), input);
  for (float& v : input.plane(plane_of(plan, Aov::depth, 0))) v *= 64;
  EXPECT_TRUE(same_bits(filtered(resolved(plan, {.diameter = 1024}), input), expected));
}

}  // namespace
}  // namespace tessera
