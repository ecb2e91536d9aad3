// SPDX-License-Identifier: Apache-2.0
// What is true of RDFC (Rousselle, Manzi and Zwicker 2013).
#include "tests/reference/rdfc.h"

#include <cmath>
#include <random>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class Rdfc : public OnDevice {
 protected:
  // Grey noise of the given deviation about 1 on flat surfaces.
  static Image noise(const FilterPlan& plan, const Region& region, float deviation) {
    Image input = made_up_input(plan, region, "constant");
    std::mt19937 random(2013);
    std::normal_distribution<float> normal(1, deviation);
    for (int c = 0; c < 3; ++c) {
      std::ranges::fill(input.plane(plane_of(plan, Aov::color, c, Statistic::variance_of_mean)),
                        deviation * deviation);
      for (float& v : input.plane(plane_of(plan, Aov::color, c))) v = normal(random);
    }
    for (int k = 0; k < input.planes(); ++k)
      if (plan.inputs()[k].aov != Aov::color && plan.inputs()[k].statistic == Statistic::variance_of_mean)
        std::ranges::fill(input.plane(k), 0.0f);
    return input;
  }
  static double variance(const Image& image) {
    double squares = 0;
    for (const float v : image.data()) squares += std::pow(v - 1.0, 2);
    return squares / static_cast<double>(image.data().size());
  }
};

TEST_F(Rdfc, LeavesAStepWithoutVarianceAsItIs) {
  const FilterPlan plan = parse_filter("rdfc");
  Image input = noise(plan, {0, 0, 60, 40}, 0);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 60; ++x) input.at(plane_of(plan, Aov::color, c), x, y) = x < 27 ? 0.3f : 0.9f;
  const Image result = filtered(plan, input);
  for (int c = 0; c < 3; ++c)
    EXPECT_TRUE(std::ranges::equal(result.plane(c), input.plane(plane_of(plan, Aov::color, c))));
}

TEST_F(Rdfc, TakesNearlyAllNoiseFromAFlatSurface) {
  const FilterPlan plan = parse_filter("rdfc");
  const Image result = filtered(plan, noise(plan, {0, 0, 96, 80}, 0.2f));
  EXPECT_LT(variance(result), 0.04 / 30);
}

TEST_F(Rdfc, DoesNotMixWhatAnAlbedoParts) {
  const FilterPlan plan = parse_filter("rdfc");
  const Region region{0, 0, 60, 40};
  Image input = noise(plan, region, 0.3f), other = input;
  for (Image* image : {&input, &other})
    for (const Share share : {Share::all, Share::a, Share::b}) {
      const std::vector<Channel> inputs = plan.inputs();
      for (int c = 0; c < 3; ++c) {
        const auto plane = std::ranges::find(inputs, Channel{Aov::albedo, c, Statistic::mean, share});
        for (int y = 0; y < 40; ++y)
          for (int x = 0; x < 60; ++x)
            image->at(static_cast<int>(plane - inputs.begin()), x, y) = x < 30 ? 0.1f : 0.9f;
      }
    }
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 40; ++y)
      for (int x = 30; x < 60; ++x) other.at(plane_of(plan, Aov::color, c), x, y) *= 1.25f;
  const Image a = filtered(plan, input), b = filtered(plan, other);
  // Behind the edge colours are seen by patches only: those of the window, of the errors and of the choice.
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 30 - 13 - 1 - 5; ++x) ASSERT_EQ(a.at(1, x, y), b.at(1, x, y)) << x << ", " << y;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 30; ++x) ASSERT_NEAR(a.at(1, x, y), b.at(1, x, y), 0.1) << x << ", " << y;
}

// The derivative of which Stein's estimate is made, against the difference that a small change makes.
TEST_F(Rdfc, EstimatesErrorsByTheDerivativeOfItsFilters) {
  const FilterPlan plan = parse_filter("rdfc:window=4");
  const Region region{0, 0, 19, 17};
  constexpr double kStep = 1e-3;
  for (const std::string_view kind : {"noise", "sky"})
    for (int candidate = 0; candidate < 3; ++candidate)
      for (const auto& [x, y] : {std::pair{9, 8}, std::pair{0, 0}, std::pair{18, 11}}) {
        const Image input = made_up_input(plan, region, kind);
        const std::size_t p = static_cast<std::size_t>(y) * 19 + static_cast<std::size_t>(x);
        const auto value = [&](double change) {
          Image moved = input;
          float& v = moved.at(plane_of(plan, Aov::color, 1), x, y);
          v = static_cast<float>(v + change);
          return std::pair<double, double>{reference::rdfc_candidate(plan, moved, candidate, 1).value[p], v};
        };
        const auto [below, v0] = value(-kStep);
        const auto [above, v1] = value(kStep);
        const double expected = (above - below) / (v1 - v0);
        EXPECT_NEAR(reference::rdfc_candidate(plan, input, candidate, 1).derivative[p], expected,
                    1e-3 * std::abs(expected) + 1e-4)
            << kind << ", filter " << candidate << " at " << x << ", " << y;
      }
}

// What reaches no farther than the errors changes something only where another filter is chosen.
TEST_F(Rdfc, ReadsAsFarAsItsHalo) {
  const FilterPlan plan = parse_filter("rdfc:window=1,depth_scale=10");
  ASSERT_EQ(plan.halo(), 5 + 3 + 1 + 1 + 5);
  const Region inner{20, 20, 28, 28}, needed = grown(inner, plan.halo()),
                                      seen = grown(inner, plan.halo() - 1);
  int caught = 0;
  for (unsigned seed = 0; seed < 400 && caught == 0; ++seed) {
    const Image input = made_up_input(plan, grown(needed, 4), "noise", seed);
    const Image whole = cropped(filtered(plan, input), inner);
    const auto of = [&](const Region& outer, const Region& frame) {
      return filter(*device_, plan, cropped(input, outer), {inner, outer}, frame);
    };
    ASSERT_TRUE(same_bits(of(needed, input.region()), whole)) << seed;
    caught += !same_bits(of(seen, seen), whole);
  }
  EXPECT_GT(caught, 0);
}

// Half A has no halves: there each of them is the whole of it, and features count as noiseless.
TEST_F(Rdfc, FiltersWhereBothHalvesAreOne) {
  const FilterPlan plan = parse_filter("rdfc:depth_scale=10");
  Image input = made_up_input(plan, {0, 0, 30, 24}, "noise");
  const std::vector<Channel> inputs = plan.inputs();
  for (int k = 0; k < input.planes(); ++k) {
    if (inputs[k].share == Share::all) continue;
    Channel whole = inputs[k];
    whole.share = whole.statistic == Statistic::samples ? Share::a : Share::all;
    const auto from = std::ranges::find(inputs, whole);
    std::ranges::copy(input.plane(static_cast<int>(from - inputs.begin())), input.plane(k).begin());
  }
  const Image result = filtered(plan, input), expected = reference::rdfc(plan, input);
  for (std::size_t i = 0; i < result.data().size(); ++i)
    ASSERT_NEAR(result.data()[i], expected.data()[i], 1e-2 * expected.data()[i]);
}

TEST_F(Rdfc, OfLightOfSixtyDecadesStaysBetweenItsBounds) {
  const FilterPlan plan = parse_filter("rdfc");
  const Image result = filtered(plan, made_up_input(plan, {0, 0, 61, 47}, "extreme"));
  for (const float v : result.data()) ASSERT_TRUE(v >= 0 && v <= 1.001e30f) << v;
}

}  // namespace
}  // namespace tessera
