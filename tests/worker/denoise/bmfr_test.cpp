// SPDX-License-Identifier: Apache-2.0
// What is true of Blockwise Multi-Order Feature Regression (Koskela et al. 2019).
#include <cmath>
#include <functional>

#include "core/filter/blocks.h"
#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class Bmfr : public OnDevice {
 protected:
  // White surfaces without emission; normals and positions vary well within each block, or not at all.
  static Image surfaces(const FilterPlan& plan, const Region& region, bool flat = false) {
    Image input = made_up_input(plan, region, "constant");
    for (int y = region.y0; y < region.y1; ++y)
      for (int x = region.x0; x < region.x1; ++x)
        for (int c = 0; c < 3; ++c) {
          input.at(plane_of(plan, Aov::albedo, c), x, y) = 1;
          const double slant = 0.9 * x + 0.7 * y;
          const double normal[] = {std::sin(0.31 * x), std::sin(0.23 * y + 0.11 * x),
                                   std::cos(0.41 * (x - y))};
          const double position[] = {0.1 * x, 0.08 * y + 0.02 * x, 300 + std::sin(slant)};
          input.at(plane_of(plan, Aov::normal, c), x, y) = flat ? 0.5f : static_cast<float>(normal[c]);
          input.at(plane_of(plan, Aov::position, c), x, y) = flat ? 7.0f : static_cast<float>(position[c]);
        }
    return input;
  }
  static void light(Image& input, const FilterPlan& plan, const std::function<double(int, int, int)>& value) {
    const Region& r = input.region();
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x)
        for (int c = 0; c < 3; ++c)
          input.at(plane_of(plan, Aov::color, c), x, y) = static_cast<float>(value(c, x, y));
  }
  // From 0 to 1, without a pattern.
  static double noise(int c, int x, int y) {
    const double v = std::sin(12.9898 * x + 78.233 * y + 37.719 * c) * 43758.5453;
    return v - std::floor(v);
  }
  static Image colors(const Image& input, const FilterPlan& plan) {
    Image out(input.region(), 3);
    for (int c = 0; c < 3; ++c)
      std::ranges::copy(input.plane(plane_of(plan, Aov::color, c)), out.plane(c).begin());
    return out;
  }
};

TEST_F(Bmfr, ReproducesEveryCombinationOfItsFeatures) {
  for (const std::string_view text :
       {"bmfr:clamp=1000", "bmfr:clamp=1000,grids=1", "bmfr:clamp=1000,block=16",
        "bmfr:clamp=1000,regularisation=stochastic"}) {
    const FilterPlan plan = parse_filter(text);
    Image input = surfaces(plan, {0, 0, 75, 70});
    light(input, plan, [&](int c, int x, int y) {
      const auto feature = [&](Aov a, int k) { return double(input.at(plane_of(plan, a, k), x, y)); };
      double v = 4 + c;
      for (int k = 0; k < 3; ++k) {
        const double p = feature(Aov::position, k) - (k == 2 ? 300 : 3);
        v += 0.3 * (k - c) * feature(Aov::normal, k) + 0.1 * (1 + k) * p + 0.05 * (c - k) * p * p;
      }
      return v;
    });
    const Image result = filtered(plan, input), expected = colors(input, plan);
    for (std::size_t i = 0; i < result.data().size(); ++i)
      ASSERT_NEAR(result.data()[i], expected.data()[i], 1e-3 * expected.data()[i]) << text << ", value " << i;
  }
}

TEST_F(Bmfr, KeepsTheMeanOfEachBlock) {
  const FilterPlan plan = parse_filter("bmfr:clamp=1000,grids=1,frame=3");
  Image input = surfaces(plan, {-7, 5, 150, 120});
  light(input, plan, [](int c, int x, int y) { return 3 + noise(c, x, y) + 0.01 * x; });  // none negative
  const Image result = filtered(plan, input);
  const BlockGrid grid = block_grid(plan);
  int blocks = 0;
  for (int y = grid.y; y < 120; y += grid.edge)
    for (int x = grid.x; x < 150; x += grid.edge) {
      const Region block{x, y, x + grid.edge, y + grid.edge};
      if (!input.region().contains(block)) continue;
      ++blocks;
      for (int c = 0; c < 3; ++c) {
        double noisy = 0, fitted = 0;
        for (int j = block.y0; j < block.y1; ++j)
          for (int i = block.x0; i < block.x1; ++i) {
            noisy += input.at(plane_of(plan, Aov::color, c), i, j);
            fitted += result.at(c, i, j);
          }
        ASSERT_NEAR(fitted, noisy, 1e-6 * noisy) << "block at " << x << ", " << y;
      }
    }
  EXPECT_GE(blocks, 6);
}

TEST_F(Bmfr, ShowsBlocksWithOneGridAndNoneWithFour) {
  // The largest mean step from a column to the next where blocks of the first grid meet, to that elsewhere.
  const auto steps = [&](std::string_view text) {
    const FilterPlan plan = parse_filter(text);
    Image input = surfaces(plan, {0, 0, 200, 160});
    light(input, plan, [](int c, int x, int y) { return 5 + 4 * noise(c, x, y) + (x * x + y * y < 19000); });
    for (int c = 0; c < 3; ++c)  // normals say nothing: what steps is what the fits differ by
      for (float& v : input.plane(plane_of(plan, Aov::normal, c))) v = 0.5f;
    for (float& v : input.plane(plane_of(plan, Aov::position, 2))) v = 1;
    const Image result = filtered(plan, input);
    const BlockGrid grid = block_grid(plan);
    double at_borders = 0, inside = 0;
    for (int x = 1; x < 200; ++x) {
      double step = 0;
      for (int y = 0; y < 160; ++y) step += std::abs(result.at(1, x, y) - result.at(1, x - 1, y));
      double& most = (x - grid.x) % grid.edge == 0 ? at_borders : inside;
      most = std::max(most, step);
    }
    return at_borders / inside;
  };
  EXPECT_GT(steps("bmfr:grids=1"), 3);
  EXPECT_LT(steps("bmfr:grids=2"), 1.25);
  EXPECT_LT(steps("bmfr:grids=3"), 1.25);
  EXPECT_LT(steps("bmfr:grids=4"), 1.25);
}

TEST_F(Bmfr, ClampsAFireflyTwiceToItsQuartersMeanAndThreeDeviations) {
  const FilterPlan plan = parse_filter("bmfr:grids=1"), unclamped = parse_filter("bmfr:grids=1,clamp=17");
  const BlockGrid grid = block_grid(plan);
  const int x0 = grid.x + grid.edge, y0 = grid.y + grid.edge;
  Image input = surfaces(plan, {0, 0, 70, 70}, true);
  light(input, plan, [&](int, int x, int y) { return x == x0 + 29 && y == y0 + 30 ? 1000 : 0; });
  const double once = 1 / 256.0 + 3 * std::sqrt(1 / 256.0 - 1 / 65536.0),
               expected = 1000 * once * once / 1024;
  const Image result = filtered(plan, input), all = filtered(unclamped, input);
  for (int y = 0; y < 70; ++y)
    for (int x = 0; x < 70; ++x) {
      const bool block = x >= x0 && x < x0 + grid.edge && y >= y0 && y < y0 + grid.edge;
      ASSERT_NEAR(result.at(1, x, y), block ? expected : 0, 1e-5 * expected) << x << ", " << y;
      ASSERT_NEAR(all.at(1, x, y), block ? 1000.0 / 1024 : 0, 1e-6) << x << ", " << y;
    }
}

TEST_F(Bmfr, FillsABlockBeyondTheBorderWithTheMirroredPicture) {
  const FilterPlan plan = parse_filter("bmfr:grids=1,block=8,clamp=1000");
  const BlockGrid grid = block_grid(plan);
  Image input = surfaces(plan, {grid.x + 6, grid.y, grid.x + 24, grid.y + 8}, true);
  light(input, plan, [&](int, int x, int) { return 1 << (x - grid.x - 6); });
  // Two of the first block's columns are inside, which six more mirror.
  const double expected = (4 * 0 + 1 + 2 + 1 + 2 + 4 + 8 + 16 + 32) / 8.0;
  const Image result = filtered(plan, input);
  for (int y = grid.y; y < grid.y + 8; ++y)
    for (int x = grid.x + 6; x < grid.x + 8; ++x) ASSERT_NEAR(result.at(0, x, y), expected, 1e-5 * expected);
}

TEST_F(Bmfr, AddsNoiseThatAmountsToTheRidge) {
  const FilterPlan ridge = parse_filter("bmfr:epsilon=0.1"),
                   noisy = parse_filter("bmfr:epsilon=0.1,regularisation=stochastic");
  Image input = surfaces(ridge, {0, 0, 130, 110});
  light(input, ridge, [](int c, int x, int y) { return 1 + noise(c, x, y) + std::sin(0.05 * x + 0.3 * y); });
  const Image a = filtered(ridge, input), b = filtered(noisy, input);
  const Image none = filtered(parse_filter("bmfr:epsilon=0.001"), input);
  double noise = 0, shrinkage = 0;
  for (std::size_t i = 0; i < a.data().size(); ++i) {
    noise += std::pow(a.data()[i] - b.data()[i], 2);
    shrinkage += std::pow(a.data()[i] - none.data()[i], 2);
  }
  EXPECT_LT(noise, 0.5 * shrinkage);
  EXPECT_GT(noise, 0);
}

TEST_F(Bmfr, DoesNotLookAtWhereTheSkyIs) {
  const FilterPlan plan = parse_filter("bmfr");
  const Region region{0, 0, 70, 50};
  const Image input = made_up_input(plan, region, "sky");
  Image far = input;
  for (int y = region.y0; y < region.y1; ++y)
    for (int x = region.x0; x < region.x1; ++x)
      if (input.at(plane_of(plan, Aov::depth, 0), x, y) == kSkyDepth)
        for (int c = 0; c < 3; ++c) far.at(plane_of(plan, Aov::position, c), x, y) = 1e20f;
  EXPECT_TRUE(same_bits(filtered(plan, far), filtered(plan, input)));
}

TEST_F(Bmfr, FitsPositionsOfAnyScaleFarFromTheOrigin) {
  // The same picture in a world that is 2^40 times as large, or 2^20 extents away: what floats keep of it.
  const FilterPlan plan = parse_filter("bmfr");
  const Region region{0, 0, 64, 64};
  Image input = surfaces(plan, region);
  light(input, plan, [](int c, int x, int y) { return 1 + noise(c, x, y); });
  for (int c = 0; c < 3; ++c)
    for (float& v : input.plane(plane_of(plan, Aov::position, c)))
      v = std::round(64 * (v - (c == 2 ? 300 : 0)));
  const Image expected = filtered(plan, input);
  Image large = input, far = input;
  for (int c = 0; c < 3; ++c) {
    for (float& v : large.plane(plane_of(plan, Aov::position, c))) v *= 0x1p40f;
    for (float& v : far.plane(plane_of(plan, Aov::position, c))) v += 0x1p23f;
  }
  EXPECT_TRUE(same_bits(filtered(plan, large), expected));
  const Image there = filtered(plan, far);
  for (std::size_t i = 0; i < there.data().size(); ++i)
    ASSERT_NEAR(there.data()[i], expected.data()[i], 1e-3);
}

}  // namespace
}  // namespace tessera
