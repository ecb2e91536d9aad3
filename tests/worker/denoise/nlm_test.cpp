// SPDX-License-Identifier: Apache-2.0
// What is true of non-local means.
#include <cmath>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class NonLocalMeans : public OnDevice {};

// Over what of the window about (x, y) lies in the picture.
double box_mean(const Image& image, int plane, int x, int y, int radius) {
  const Region box = intersect({x - radius, y - radius, x + radius + 1, y + radius + 1}, image.region());
  double sum = 0;
  for (int j = box.y0; j < box.y1; ++j)
    for (int i = box.x0; i < box.x1; ++i) sum += image.at(plane, i, j);
  return sum / static_cast<double>(box.area());
}

TEST_F(NonLocalMeans, LeaveAStepWithoutVarianceAsItIs) {
  const Region region{0, 0, 40, 30};
  for (const std::string_view text :
       {"nlm", "nlm:mode=prefilter,patch_mode=exp_of_mean", "nlm:mode=prefilter"}) {
    const FilterPlan plan = parse_filter(text);
    Image input = made_up_input(plan, region, "converged");
    for (int k = 0; k < input.planes(); ++k)
      if (plan.inputs()[k].statistic == Statistic::mean)
        for (int y = 0; y < 30; ++y)
          for (int x = 0; x < 40; ++x) input.at(k, x, y) = x < 17 ? 0.3f : 0.7f;
    const Image result = filtered(plan, input);
    // A mean of exponentials takes a patch across the edge where a pair of its pixels is not: up to a window
    // away.
    const int blurred = plan.is("mode", "prefilter") && plan.is("patch_mode", "mean_of_exp") ? 5 : 0;
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 40; ++x)
        if (x < 17 - blurred || x >= 17 + blurred) {
          ASSERT_EQ(result.at(1, x, y), x < 17 ? 0.3f : 0.7f) << text << " at " << x;
        }
  }
}

// Tiles of the kernels that have the picture all around them are a case of their own.
TEST_F(NonLocalMeans, OfALargePictureAreThoseOfItsTiles) {
  const Region region{0, 0, 420, 210};
  for (const std::string_view text :
       {"nlm:radius=1,patch=1", "nlm:mode=prefilter,radius=1,patch=1", "fdf:radius=1"}) {
    const FilterPlan plan = parse_filter(text);
    const Image input = made_up_input(plan, region, "noise");
    EXPECT_TRUE(same_bits(stitched(plan, input, {37, 53}), filtered(plan, input))) << text;
  }
}

TEST_F(NonLocalMeans, FilterEitherHalfWithTheWeightsOfTheOther) {
  const FilterPlan plan = parse_filter("nlm:radius=4");
  const Region region{0, 0, 37, 29};
  Image input = made_up_input(plan, region, "noise");
  const std::vector<Channel> inputs = plan.inputs();
  const auto first = [&](Share half) {
    return static_cast<int>(std::ranges::find(inputs, Channel{Aov::color, 0, Statistic::mean, half}) -
                            inputs.begin());
  };
  const int a = first(Share::a), b = first(Share::b);
  // A alone would be left as it is, and B averaged: all of A is alike, so that its weights are 1.
  for (int c = 0; c < 3; ++c) std::ranges::fill(input.plane(a + c), 0.25f);
  const Image result = filtered(plan, input);
  for (int y = 0; y < 29; ++y)
    for (int x = 0; x < 37; ++x)
      for (int c = 0; c < 3; ++c) {
        const double expected = 0.5 * (0.25 + box_mean(input, b + c, x, y, 4));
        ASSERT_NEAR(result.at(c, x, y), expected, 1e-6) << x << ", " << y;
      }
}

TEST_F(NonLocalMeans, TakeOffTheDistanceThatNoiseMakes) {
  // Two pixels of variance V are 2 V apart, squared, on average: that much counts as no distance.
  const FilterPlan plan = parse_filter("nlm:radius=4");
  const Region region{0, 0, 24, 20};
  Image input = made_up_input(plan, region, "noise");
  for (int k = 0; k < input.planes(); ++k) {
    const bool mean = plan.inputs()[k].statistic == Statistic::mean;
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 24; ++x) input.at(k, x, y) = mean ? ((x + y) % 2 ? 0.4f : 0.6f) : 0.0201f;
  }
  const Image result = filtered(plan, input);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x)
      ASSERT_NEAR(result.at(0, x, y), box_mean(input, 0, x, y, 4), 1e-6) << x << ", " << y;
}

}  // namespace
}  // namespace tessera
