// SPDX-License-Identifier: Apache-2.0
// What is true of the history of Blockwise Multi-Order Feature Regression (Koskela et al. 2019).
#include <cmath>
#include <random>

#include "core/filter/blocks.h"
#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

// Planes of the output.
constexpr int kLight = 3, kCount = 6, kFiltered = 15;

class BmfrHistory : public OnDevice {
 protected:
  const Region frame_{0, 0, 96, 80};

  // One white wall at rest, a hundredth of a unit from pixel to pixel, lit by noise.
  static Image wall(const FilterPlan& plan, const Region& region, unsigned seed) {
    Image input = made_up_input(plan, region, "constant");
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(2, 1);
    const auto set = [&](Aov a, int c, float v) { std::ranges::fill(input.plane(plane_of(plan, a, c)), v); };
    set(Aov::depth, 0, 4);
    for (int c = 0; c < 3; ++c) {
      for (float& v : input.plane(plane_of(plan, Aov::color, c))) v = noise(random);
      set(Aov::albedo, c, 1);
      set(Aov::normal, c, c == 2);
      for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x)
          input.at(plane_of(plan, Aov::position, c), x, y) =
              c == 2 ? -4.0f : 0.01f * static_cast<float>(c == 0 ? x : y);
    }
    if (plan.history() == 0) return input;
    set(Aov::motion, 0, 0);
    set(Aov::motion, 1, 0);
    if (!plan.is("test", "moving")) return input;
    set(Aov::previous_depth, 0, 4);
    set(Aov::object_id, 0, 7);
    return input;
  }
  static Image kept(const FilterPlan& plan, const Image& output) {
    return planes_of(output, 3, plan.history());
  }
  // Frames that the pixel in the middle has been found in, after a second one that `change` made of the
  // first.
  template <typename Change>
  float found(std::string_view text, const Change& change) {
    const FilterPlan plan = parse_filter(text);
    Image input = wall(plan, frame_, 1);
    const Image history = kept(plan, filtered_and_kept(plan, input));
    change(plan, input);
    return filtered_and_kept(plan, input, history).at(kCount, 48, 40);
  }
  static void add(Image& input, const FilterPlan& plan, Aov aov, int index, float by) {
    for (float& v : input.plane(plane_of(plan, aov, index))) v += by;
  }
};

TEST_F(BmfrHistory, OfAFirstFrameChangesNothingButWhatIsKept) {
  for (const auto& [with, without] :
       {std::pair{"bmfr:history=on", "bmfr"}, std::pair{"bmfr:history=on,grids=1", "bmfr:grids=1"},
        std::pair{"bmfr:block=8,history=on,taa=on", "bmfr:block=8"}}) {
    const FilterPlan plan = parse_filter(with), plain = parse_filter(without);
    const Image input = made_up_input(plan, {0, 0, 61, 47}, "sky");
    const Image same = planes_of(input, 0, static_cast<int>(plain.inputs().size()));
    EXPECT_TRUE(same_bits(filtered(plan, input), filtered(plain, same))) << with;
  }
}

TEST_F(BmfrHistory, AveragesLightByTheShareOfAFrameAndNoLessThanAlpha) {
  const FilterPlan plan = parse_filter("bmfr:history=on");
  const Region region{0, 0, 160, 160};
  Image history;
  double factor = 1;
  for (unsigned number = 1; number <= 12; ++number) {
    const Image output = filtered_and_kept(plan, wall(plan, region, number), history);
    history = kept(plan, output);
    const double a = std::max(0.2, 1.0 / number);
    factor = a * a + (1 - a) * (1 - a) * (number == 1 ? 0 : factor);
    double sum = 0, squares = 0;
    for (const float v : output.plane(kLight + 1)) sum += v, squares += double(v) * v;
    const double count = static_cast<double>(region.area()), mean = sum / count;
    EXPECT_NEAR(mean, 2, 5 * std::sqrt(factor / count)) << number;
    EXPECT_NEAR(squares / count - mean * mean, factor, 5 * factor * std::sqrt(2 / count)) << number;
    EXPECT_THAT(output.plane(kCount), testing::Each(static_cast<float>(number)));
  }
}

TEST_F(BmfrHistory, MixesWhatWasFittedByTheShareOfAFrameAndNoLessThanItsAlpha) {
  const FilterPlan plan = parse_filter("bmfr:history=on,grids=1,alpha=0.001");
  const Image input = wall(plan, frame_, 1);
  const Image first = filtered_and_kept(plan, input);
  for (const auto& [frames, share] :
       {std::pair{1.0f, 0.5f}, std::pair{4.0f, 0.2f}, std::pair{9.0f, 0.1f}, std::pair{100.0f, 0.1f}}) {
    Image history = kept(plan, first);
    std::ranges::fill(history.plane(kCount - 3), frames);
    for (int c = 0; c < 3; ++c) std::ranges::fill(history.plane(kFiltered - 3 + c), 9.0f);
    const Image second = filtered_and_kept(plan, input, history);
    // The same light is accumulated and fitted again.
    for (int k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < first.plane(0).size(); ++i) {
        const float expected = 9 + share * (first.plane(kFiltered + k)[i] - 9);
        ASSERT_NEAR(second.plane(kFiltered + k)[i], expected, 1e-4f) << frames;
        ASSERT_EQ(second.plane(kFiltered + k)[i], second.plane(k)[i]) << "white, and nothing glows";
      }
  }
}

TEST_F(BmfrHistory, CountsNoMoreThan255Frames) {
  const FilterPlan plan = parse_filter("bmfr:history=on,alpha=0.001");
  const Image input = wall(plan, frame_, 1), first = filtered_and_kept(plan, input);
  for (const auto& [before, after] :
       {std::pair{1.0f, 2.0f}, std::pair{253.0f, 254.0f}, std::pair{254.0f, 255.0f},
        std::pair{255.0f, 255.0f}, std::pair{256.0f, 1.0f}, std::pair{0.5f, 1.0f}}) {
    Image history = kept(plan, first);
    std::ranges::fill(history.plane(kCount - 3), before);
    EXPECT_THAT(filtered_and_kept(plan, input, history).plane(kCount), testing::Each(after)) << before;
  }
}

TEST_F(BmfrHistory, ComesFromTheSamePointOfTheSameSurface) {
  constexpr std::string_view by_position = "bmfr:history=on,test=position", moving = "bmfr:history=on";
  const auto shift = [](float by) {
    return [by](const FilterPlan& plan, Image& input) { add(input, plan, Aov::position, 0, by); };
  };
  for (const std::string_view text : {by_position, moving})
    EXPECT_EQ(found(text, [](const FilterPlan&, Image&) {}), 2) << text;
  // A footprint is the diagonal of a hundredth; a point may be two of them away.
  EXPECT_EQ(found(by_position, shift(0.028f)), 2);
  EXPECT_EQ(found(by_position, shift(0.029f)), 1);
  EXPECT_EQ(found("bmfr:history=on,test=position,limit_p=5", shift(0.07f)), 2);
  EXPECT_EQ(found("bmfr:history=on,test=position,limit_p=5", shift(0.072f)), 1);
  EXPECT_EQ(found("bmfr:history=on,test=position,distance_p=0.5", shift(0.49f)), 2);
  EXPECT_EQ(found("bmfr:history=on,test=position,distance_p=0.5", shift(0.51f)), 1);
}

TEST_F(BmfrHistory, FollowsWhatHasMovedByItsDepthAndObject) {
  const auto moved = [](float deeper, float object) {
    return [=](const FilterPlan& plan, Image& input) {
      add(input, plan, Aov::position, 1, 100);
      add(input, plan, Aov::previous_depth, 0, deeper);
      add(input, plan, Aov::object_id, 0, object);
    };
  };
  EXPECT_EQ(found("bmfr:history=on", moved(0, 0)), 2);
  EXPECT_EQ(found("bmfr:history=on", moved(0.02f, 0)), 2);
  EXPECT_EQ(found("bmfr:history=on", moved(0.03f, 0)), 1);
  EXPECT_EQ(found("bmfr:history=on", moved(0, 1)), 1);
}

TEST_F(BmfrHistory, HasOneNormalOnEverySurface) {
  const auto turned = [](float by) {
    return [by](const FilterPlan& plan, Image& input) { add(input, plan, Aov::normal, 0, by); };
  };
  EXPECT_EQ(found("bmfr:history=on", turned(0.49f)), 2);
  EXPECT_EQ(found("bmfr:history=on", turned(0.51f)), 1);
  EXPECT_EQ(found("bmfr:history=on,limit_n=0.1", turned(0.11f)), 1);
}

TEST_F(BmfrHistory, FollowsWhatMovesByWholePixelsBitForBit) {
  const FilterPlan plan = parse_filter("bmfr:history=on");
  const Image scene = wall(plan, {0, 0, 90, 70}, 1);
  const auto shown = [&](int x, int y) {
    const Image part = cropped(scene, {x, y, x + 60, y + 50});
    Image moved({0, 0, 60, 50}, part.planes());
    std::ranges::copy(part.data(), moved.data().begin());
    return moved;
  };
  const Image history = kept(plan, filtered_and_kept(plan, shown(20, 10)));
  Image input = shown(17, 12);
  std::ranges::fill(input.plane(plane_of(plan, Aov::motion, 0)), 3.0f);
  std::ranges::fill(input.plane(plane_of(plan, Aov::motion, 1)), -2.0f);
  const Image after = filtered_and_kept(plan, input, history), alone = filtered_and_kept(plan, input);
  for (int c = 0; c < 3; ++c)
    EXPECT_TRUE(std::ranges::equal(after.plane(kLight + c), alone.plane(kLight + c)));
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 60; ++x)
      ASSERT_EQ(after.at(kCount, x, y), x >= 3 && y < 48 ? 2 : 1) << x << ", " << y;
}

TEST_F(BmfrHistory, ShowsNoBlocksWhereTheirGridHasMovedFromFrameToFrame) {
  // The largest mean step from a column to the next, to the mean of all.
  const auto steps = [](const Image& i) {
    double most = 0, all = 0;
    for (int x = 1; x < i.region().x1; ++x) {
      double step = 0;
      for (int y = 0; y < i.region().y1; ++y) step += std::abs(i.at(1, x, y) - i.at(1, x - 1, y));
      most = std::max(most, step);
      all += step / (i.region().x1 - 1);
    }
    return most / all;
  };
  const FilterPlan asked = parse_filter("bmfr:history=on,grids=1,normals=off,positions=off");
  Image history, first, last;
  for (int number = 0; number < 32; ++number) {
    const FilterPlan plan = resolved(asked, {.frame = number});
    EXPECT_EQ(plan["frame"], number % 16);
    const Image output =
        filtered_and_kept(plan, wall(plan, {0, 0, 160, 120}, static_cast<unsigned>(number)), history);
    history = kept(plan, output);
    (number == 0 ? first : last) = planes_of(output, 0, 3);
  }
  EXPECT_GT(steps(first), 10);
  EXPECT_LT(steps(last), 0.5 * steps(first));
  const FilterPlan left_to_it = resolved(parse_filter("bmfr:history=on,normals=off,positions=off"), {.frame = 0});
  const Image alone = filtered_and_kept(left_to_it, wall(left_to_it, {0, 0, 160, 120}, 0), {});
  EXPECT_LT(steps(alone), 0.5 * steps(first)) << "a frame without a history takes more grids";
}

TEST_F(BmfrHistory, TakesTheGridsOfThePaperAndFourWithoutIt) {
  EXPECT_EQ(grids_taken(parse_filter("bmfr").parameters), 4);
  EXPECT_EQ(grids_taken(parse_filter("bmfr:history=on").parameters), 1);
  EXPECT_EQ(grids_taken(parse_filter("bmfr:history=on,grids=3").parameters), 3);
  EXPECT_EQ(grids_taken(without_history(parse_filter("bmfr:history=on")).parameters), 4);
  EXPECT_EQ(grids_taken(without_history(parse_filter("bmfr:history=on,grids=1")).parameters), 1);
}

}  // namespace
}  // namespace tessera
