// SPDX-License-Identifier: Apache-2.0
// What is true of temporal anti-aliasing, whichever filter it ends.
#include <cmath>

#include "core/filter/taa.h"
#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

// Blocks that know the constant alone, and of one grid: a picture with steps in it, of which each test knows
// the steps.
class Taa : public OnDevice {
 protected:
  const FilterPlan plan_ = parse_filter("bmfr:block=8,taa=on,normals=off,positions=off,grids=1");
  const FilterPlan without_ = parse_filter("bmfr:block=8,normals=off,positions=off,grids=1");
  const Region frame_{0, 0, 64, 48};

  static Image still(const FilterPlan& plan, const Region& region, unsigned seed = 1) {
    Image input = made_up_input(plan, region, "noise", seed);
    for (int c = 0; c < 2; ++c) std::ranges::fill(input.plane(plane_of(plan, Aov::motion, c)), 0.0f);
    return input;
  }
  static void move(Image& input, const FilterPlan& plan, float x, float y) {
    std::ranges::fill(input.plane(plane_of(plan, Aov::motion, 0)), x);
    std::ranges::fill(input.plane(plane_of(plan, Aov::motion, 1)), y);
  }
  Image picture_of(const Image& input) {
    return filtered(without_, planes_of(input, 0, static_cast<int>(without_.inputs().size())));
  }
};

TEST_F(Taa, YieldsAFirstFrameAsItIsAndKeepsIt) {
  const Image input = still(plan_, frame_), result = filtered_and_kept(plan_, input);
  ASSERT_EQ(result.planes(), 3 + kTaaPlanes);
  EXPECT_TRUE(same_bits(planes_of(result, 0, 3), picture_of(input)));
  EXPECT_TRUE(same_bits(planes_of(result, 3, 3), planes_of(result, 0, 3)));
}

// Of nine numbers none is farther than sqrt(8) deviations from the mean.
TEST_F(Taa, LeavesAPictureAtRestAsItIsWhereNothingIsClipped) {
  FilterPlan wide = plan_;
  wide.parameters["taa_gamma"] = 3;
  const Image input = still(wide, frame_), first = filtered(wide, input);
  EXPECT_TRUE(same_bits(filtered_and_kept(wide, input, first), filtered_and_kept(wide, input)));
}

TEST_F(Taa, TakesAlphaOfTheNewPictureWhereNothingIsClipped) {
  FilterPlan wide = plan_;
  wide.parameters["taa_gamma"] = 100;
  wide.parameters["taa_alpha"] = 0.25;
  const Image input = still(wide, frame_), now = picture_of(input);
  Image history = now;
  for (int y = 0; y < frame_.y1; ++y)
    for (int x = 0; x < frame_.x1; ++x)
      for (int c = 0; c < 3; ++c) history.at(c, x, y) *= x % 8 == 3 ? 1.01f : 1.0f;
  const Image mixed = filtered_and_kept(wide, input, history);
  const auto luminance = [](const Image& i, int x, int y) {
    return 0.2126 * i.at(0, x, y) + 0.7152 * i.at(1, x, y) + 0.0722 * i.at(2, x, y);
  };
  int unclipped = 0;
  for (int y = 0; y < frame_.y1; ++y)
    for (int x = 0; x < frame_.x1; ++x) {
      const double a = 0.25 / (1 + luminance(now, x, y)), b = 0.75 / (1 + luminance(history, x, y));
      const double expected = (a * now.at(1, x, y) + b * history.at(1, x, y)) / (a + b);
      unclipped +=
          std::abs(mixed.at(1, x, y) - expected) < 1e-6 * expected && history.at(1, x, y) != now.at(1, x, y);
    }
  EXPECT_GT(unclipped, 100);
}

TEST_F(Taa, DrawsWhatWasElsewhereIntoWhatNeighboursAreNow) {
  const Image input = still(plan_, frame_), now = picture_of(input);
  Image history = now;
  for (float& v : history.data()) v = 1000;
  const Image result = planes_of(filtered_and_kept(plan_, input, history), 0, 3);
  for (int y = 0; y < frame_.y1; ++y)
    for (int x = 0; x < frame_.x1; ++x) {
      float high[3] = {}, range = 0;
      for (int c = 0; c < 3; ++c) {
        float low = INFINITY;
        for (int j = std::max(y - 1, 0); j < std::min(y + 2, frame_.y1); ++j)
          for (int i = std::max(x - 1, 0); i < std::min(x + 2, frame_.x1); ++i) {
            low = std::min(low, now.at(c, i, j));
            high[c] = std::max(high[c], now.at(c, i, j));
          }
        range = std::max(range, high[c] - low);
      }
      // Deviations of Y, Co and Cg together reach no farther than the widest channel's range.
      for (int c = 0; c < 3; ++c)
        ASSERT_LE(result.at(c, x, y), high[c] + range + 1e-6f * high[c]) << x << ", " << y;
    }
}

TEST_F(Taa, FollowsTheLongestMotionAround) {
  Image input = still(plan_, frame_);
  FilterPlan old = plan_;
  old.parameters["taa_alpha"] = 0.01;
  old.parameters["taa_gamma"] = 100;
  const Image now = picture_of(input);
  Image history = now;
  for (int y = 0; y < frame_.y1; ++y) history.at(0, 20, y) += 0.02f * history.at(0, 20, y);
  const Image before = filtered_and_kept(old, input, history);
  input.at(plane_of(plan_, Aov::motion, 0), 30, 20) = 10;  // one pixel comes from x = 20
  const Image after = filtered_and_kept(old, input, history);
  for (int y = 0; y < frame_.y1; ++y)
    for (int x = 0; x < frame_.x1; ++x) {
      const bool around = std::abs(x - 30) <= 1 && std::abs(y - 20) <= 1;
      if (!around) {
        ASSERT_EQ(after.at(0, x, y), before.at(0, x, y)) << x << ", " << y;
      }
    }
  int moved = 0;
  for (int y = 19; y <= 21; ++y)
    for (int x = 29; x <= 31; ++x) moved += after.at(0, x, y) != before.at(0, x, y);
  EXPECT_GE(moved, 3);
}

TEST_F(Taa, HasNothingToMixWhereThePictureCameFromOutside) {
  Image input = still(plan_, frame_);
  Image history = picture_of(input);
  for (float& v : history.data()) v *= 1.5f;
  for (const float away : {-100.0f, 64.8f, kSkyDepth, std::nanf("")}) {
    move(input, plan_, away, 0);
    EXPECT_TRUE(same_bits(planes_of(filtered_and_kept(plan_, input, history), 0, 3), picture_of(input)))
        << away;
  }
}

TEST_F(Taa, IsNotPoisonedByWhatIsNoNumber) {
  const Image input = still(plan_, frame_);
  Image history = picture_of(input);
  for (float& v : history.data()) v *= 1.5f;
  const Image good = filtered_and_kept(plan_, input, history);
  history.at(1, 20, 20) = NAN;
  history.at(2, 40, 30) = INFINITY;
  const Image result = filtered_and_kept(plan_, input, history);
  for (int y = 0; y < frame_.y1; ++y)
    for (int x = 0; x < frame_.x1; ++x)
      for (int c = 0; c < 3; ++c) {
        const bool bad = (x == 20 && y == 20) || (x == 40 && y == 30);
        ASSERT_EQ(result.at(c, x, y), bad ? picture_of(input).at(c, x, y) : good.at(c, x, y));
      }
}

TEST_F(Taa, AddsOnePixelToTheHalo) {
  const FilterPlan plan = parse_filter("atrous:levels=1,taa=on");
  ASSERT_EQ(plan.halo(), parse_filter("atrous:levels=1").halo() + 1);
  const Image input = still(plan, frame_);
  Image history = filtered(plan, input);
  for (float& v : history.data()) v *= 1.5f;
  const Region inner{20, 14, 40, 30}, needed = grown(inner, plan.halo());
  const Image whole = cropped(filtered_and_kept(plan, input, history), inner);
  // What lies beyond `seen` does not exist for the filter.
  const auto with_halo = [&](int halo) {
    const Region seen = grown(inner, halo);
    return filter(*device_, plan, cropped(input, seen), {inner, seen}, intersect(needed, seen),
                  cropped(history, seen));
  };
  EXPECT_TRUE(same_bits(with_halo(plan.halo()), whole));
  EXPECT_FALSE(same_bits(with_halo(plan.halo() - 1), whole));
}

TEST_F(Taa, SteadiesNoiseFromFrameToFrame) {
  const FilterPlan plain = parse_filter("bmfr:grids=1,block=8");
  const FilterPlan steady = parse_filter("bmfr:grids=1,block=8,taa=on");
  Image history, last;
  double changed = 0, steadied = 0;
  for (unsigned frame = 1; frame <= 8; ++frame) {
    Image input = still(steady, frame_, frame);
    const Image now = filtered(plain, planes_of(input, 0, static_cast<int>(plain.inputs().size())));
    const Image mixed = planes_of(filtered_and_kept(steady, input, history), 0, 3);
    if (frame > 1)
      for (std::size_t i = 0; i < now.data().size(); ++i) {
        steadied += std::abs(mixed.data()[i] - history.data()[i]);
        changed += std::abs(now.data()[i] - last.data()[i]);
      }
    last = now;
    history = mixed;
  }
  EXPECT_LT(steadied, 0.7 * changed);
}

}  // namespace
}  // namespace tessera
