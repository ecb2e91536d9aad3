// SPDX-License-Identifier: Apache-2.0
// What is true of Ray Histogram Fusion at several scales.
#include <cmath>
#include <random>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class RhfScales : public OnDevice {
 protected:
  // One surface under white noise: all histograms agree.
  Image noise(const FilterPlan& plan, const Region& region) {
    Image input = made_up_input(plan, region, "constant");
    std::mt19937 random(2014);
    std::normal_distribution<float> normal(0, 1);
    for (float& v : input.plane(plane_of(plan, Aov::color, 1))) v = normal(random);
    return input;
  }
};

TEST_F(RhfScales, ReachAsFarAsTheCoarsestOneDoes) {
  // low-pass + 2^s (radius + patch [+ patch]) + the interpolations' 3 (+ 6).
  EXPECT_EQ(parse_filter("rhf").halo(), 7);
  EXPECT_EQ(parse_filter("rhf:scales=2").halo(), 3 + 2 * 7 + 3);
  EXPECT_EQ(parse_filter("rhf:scales=2,average=patches").halo(), 3 + 2 * 8 + 3);
  EXPECT_EQ(parse_filter("rhf:scales=3").halo(), 7 + 4 * 7 + 3 + 6);
}

// The frame stays the same: its size and border count. The furthest pixels of a patch decide about others,
// but no light comes from them: that is seen now and then, somewhere.
TEST_F(RhfScales, FeelAPixelAsFarAwayAsTheHalo) {
  const Region frame{-60, -60, 140, 140};
  // Its first row and column, and its last, are interpolated from the furthest.
  const Region inner{29, 25, 60, 56};
  for (const auto& [text, sides_that_feel] :
       {std::pair{"rhf:scales=2,patch=0", 4}, std::pair{"rhf:scales=2,patch=0,radius=3", 4},
        std::pair{"rhf:scales=3,patch=0", 4}, std::pair{"rhf:scales=2", 1},
        std::pair{"rhf:scales=2,average=patches,radius=3", 1}}) {
    const FilterPlan plan = parse_filter(text);
    const Region outer = grown(inner, plan.halo());
    const Region sides_of[] = {{outer.x0, outer.y0, outer.x0 + 1, outer.y1},
                               {outer.x1 - 1, outer.y0, outer.x1, outer.y1},
                               {outer.x0, outer.y0, outer.x1, outer.y0 + 1},
                               {outer.x0, outer.y1 - 1, outer.x1, outer.y1}};
    int felt[4] = {};
    const auto sides = [&] { return static_cast<int>(std::ranges::count(felt, 1)); };
    for (unsigned seed = 0; seed < 8 && sides() < sides_that_feel; ++seed) {
      const Image input = cropped(made_up_input(plan, frame, "noise", seed), outer);
      const Image whole = filter(*device_, plan, input, {inner, outer}, frame);
      for (int k = 0; k < 4; ++k) {
        Image other = input;
        for (int y = sides_of[k].y0; y < sides_of[k].y1; ++y)
          for (int x = sides_of[k].x0; x < sides_of[k].x1; ++x) {
            other.at(plane_of(plan, Aov::color, 1), x, y) = 100;
            other.at(plane_of(plan, Aov::color, 0, Statistic::samples), x, y) = 4000;
          }
        if (!same_bits(filter(*device_, plan, other, {inner, outer}, frame), whole)) felt[k] = 1;
      }
    }
    EXPECT_GE(sides(), sides_that_feel) << text;
  }
}

TEST_F(RhfScales, HaveNoSeamWhereverTheTilesBegin) {
  for (const Region& frame : {Region{-71, -35, -8, 30}, Region{13, 1001, 66, 1048}})
    for (const char* text : {"rhf:scales=2,radius=2", "rhf:scales=3,radius=2,average=patches,gate=3"}) {
      const FilterPlan plan = parse_filter(text);
      const Image input = made_up_input(plan, frame, "noise");
      const Image whole = filtered(plan, input);
      for (const Size size : {Size{7, 5}, Size{31, 37}, Size{16, 16}, Size{63, 1}})
        ASSERT_TRUE(same_bits(stitched(plan, input, size), whole))
            << text << " in tiles of " << size.width << "x" << size.height << " from " << frame.x0;
    }
}

TEST_F(RhfScales, LieInTheGlobalGrid) {
  const auto moved = [&](const FilterPlan& plan, int x, int y) {
    const Image input = made_up_input(plan, {0, 0, 48, 40}, "noise");
    const Image there({x, y, x + 48, y + 40}, input.planes(),
                      Floats(input.data().begin(), input.data().end()));
    return filtered(plan, there);
  };
  const auto same = [](const Image& a, const Image& b) { return std::ranges::equal(a.data(), b.data()); };
  const FilterPlan two = parse_filter("rhf:scales=2"), three = parse_filter("rhf:scales=3");
  EXPECT_TRUE(same(moved(two, 2, -6), moved(two, 0, 0)));
  EXPECT_FALSE(same(moved(two, 1, 0), moved(two, 0, 0)));
  EXPECT_TRUE(same(moved(three, -4, 8), moved(three, 0, 0)));
  EXPECT_FALSE(same(moved(three, 0, 2), moved(three, 0, 0)));
}

// What is taken out of each scale is put back by the next. The third is made of the picture by one low-pass
// and compared with two, one after the other; Gaussians are cut off, and at the border divided by what is
// left of them.
TEST_F(RhfScales, LeaveAPictureAsItIsWhereNothingAgrees) {
  for (const auto& [text, tolerance] :
       {std::pair{"rhf:threshold=0.001,scales=2", 1e-6}, std::pair{"rhf:threshold=0.001,scales=3", 5e-2}}) {
    const FilterPlan plan = parse_filter(text);
    const Image input = made_up_input(plan, {0, 0, 61, 50}, "noise");
    const Image result = filtered(plan, input);
    for (int c = 0; c < 3; ++c)
      for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 61; ++x)
          ASSERT_NEAR(result.at(c, x, y), input.at(plane_of(plan, Aov::color, c), x, y), tolerance)
              << text << " at " << x << ", " << y;
  }
}

TEST_F(RhfScales, TakeTheNoiseOfLowFrequenciesThatOneScaleLeaves) {
  const Region region{0, 0, 256, 256}, inside{64, 64, 192, 192};  // out of reach of the border
  double before = 1;
  for (const char* text : {"rhf:scales=1,patch=0", "rhf:scales=2,patch=0", "rhf:scales=3,patch=0"}) {
    const FilterPlan plan = parse_filter(text);
    const Image result = cropped(filtered(plan, noise(plan, region)), inside);
    double variance = 0;
    for (const float v : result.plane(1)) variance += double(v) * v / static_cast<double>(inside.area());
    EXPECT_LT(variance, before / 2) << text;
    before = variance;
  }
}

TEST_F(RhfScales, PassAPixelWithoutSamplesThrough) {
  const FilterPlan plan = parse_filter("rhf:scales=3");
  Image input = noise(plan, {0, 0, 40, 40});
  const Image expected = filtered(plan, input);
  for (int k = 0; k < input.planes(); ++k)
    if (plan.inputs()[k].aov != Aov::depth) input.at(k, 20, 21) = 0;
  input.at(plane_of(plan, Aov::color, 1), 20, 21) = 1e6f;
  const Image result = filtered(plan, input);
  EXPECT_EQ(result.at(1, 20, 21), 1e6f);
  EXPECT_NEAR(result.at(1, 19, 21), expected.at(1, 19, 21), 0.1);
}

}  // namespace
}  // namespace tessera
