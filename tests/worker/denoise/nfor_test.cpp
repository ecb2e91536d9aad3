// SPDX-License-Identifier: Apache-2.0
// What is true of NFOR (Bitterli et al. 2016).
#include "tests/reference/nfor.h"

#include <cmath>
#include <random>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class Nfor : public OnDevice {
 protected:
  // Sets a channel of all samples and of both halves.
  static void set(Image& input, const FilterPlan& plan, Aov aov, int c, int x, int y, float v) {
    const std::vector<Channel> inputs = plan.inputs();
    for (int k = 0; k < input.planes(); ++k)
      if (inputs[k].aov == aov && inputs[k].index == c && inputs[k].statistic == Statistic::mean)
        input.at(k, x, y) = v;
  }
  static void set_variance(Image& input, const FilterPlan& plan, Aov aov, float v) {
    for (int c = 0; c < info(aov).channels; ++c)
      std::ranges::fill(input.plane(plane_of(plan, aov, c, Statistic::variance_of_mean)), v);
  }
};

TEST_F(Nfor, KeepsLightThatIsAPlaneInItsFeatures) {
  const FilterPlan plan = parse_filter("nfor:depth_scale=10");
  const Region region{0, 0, 60, 40};
  Image input = made_up_input(plan, region, "constant");
  for (const Aov a : {Aov::albedo, Aov::normal, Aov::depth}) set_variance(input, plan, a, 0);
  set_variance(input, plan, Aov::color, 100);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x) {
      const float albedo = 0.5f + 0.3f * std::sin(0.7f * x) * std::cos(0.4f * y);
      set(input, plan, Aov::albedo, 0, x, y, albedo);
      for (int c = 0; c < 3; ++c)
        set(input, plan, Aov::color, c, x, y, 0.2f + 0.5f * albedo + 0.004f * static_cast<float>(x + c * y));
    }
  const Image result = filtered(plan, input);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 60; ++x)
        ASSERT_NEAR(result.at(c, x, y), input.at(plane_of(plan, Aov::color, c), x, y), 2e-3)
            << x << ", " << y;
}

TEST_F(Nfor, TakesNearlyAllNoiseFromAFlatSurface) {
  const FilterPlan plan = parse_filter("nfor:depth_scale=10");
  Image input = made_up_input(plan, {0, 0, 70, 60}, "constant");
  std::mt19937 random(2016);
  std::normal_distribution<float> normal(0, 0.2f);
  const std::vector<Channel> inputs = plan.inputs();
  const auto plane = [&](int c, Share s) {
    return static_cast<int>(std::ranges::find(inputs, Channel{Aov::color, c, Statistic::mean, s}) -
                            inputs.begin());
  };
  for (const Aov a : {Aov::albedo, Aov::normal, Aov::depth}) set_variance(input, plan, a, 0);
  set_variance(input, plan, Aov::color, 0.02f);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 70; ++x) {
        const float a = 1 + normal(random), b = 1 + normal(random);
        input.at(plane(c, Share::a), x, y) = a;
        input.at(plane(c, Share::b), x, y) = b;
        input.at(plane(c, Share::all), x, y) = (a + b) / 2;
      }
  double squares = 0;
  const Image result = filtered(plan, input);
  for (const float v : result.data()) squares += std::pow(v - 1.0, 2);
  EXPECT_LT(squares / static_cast<double>(result.data().size()), 0.02 / 30);
}

TEST_F(Nfor, ReadsAsFarAsItsHalo) {
  const FilterPlan plan = parse_filter("nfor:window=1,depth_scale=10");
  ASSERT_EQ(plan.halo(), 5 + 3 + 1 + 1 + 1 + 1 + 1 + 3 + 1);
  ASSERT_EQ(parse_filter("nfor").halo(), 65);
  const Region inner{20, 20, 28, 28}, needed = grown(inner, plan.halo()),
                                      seen = grown(inner, plan.halo() - 1);
  int caught = 0;
  for (unsigned seed = 0; seed < 200 && caught == 0; ++seed) {
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

TEST_F(Nfor, OfLightOfSixtyDecadesStaysFinite) {
  const FilterPlan plan = parse_filter("nfor:depth_scale=10");
  const Image result = filtered(plan, made_up_input(plan, {0, 0, 61, 47}, "extreme"));
  for (const float v : result.data()) ASSERT_TRUE(std::isfinite(v)) << v;
}

// Half A has no halves: there each of them is the whole of it.
TEST_F(Nfor, FiltersWhereBothHalvesAreOne) {
  const FilterPlan plan = parse_filter("nfor:depth_scale=10");
  Image input = made_up_input(plan, {0, 0, 30, 24}, "noise");
  const std::vector<Channel> inputs = plan.inputs();
  for (int k = 0; k < input.planes(); ++k) {
    if (inputs[k].share == Share::all) continue;
    Channel whole = inputs[k];
    whole.share = whole.statistic == Statistic::samples ? Share::a : Share::all;
    const auto from = std::ranges::find(inputs, whole);
    std::ranges::copy(input.plane(static_cast<int>(from - inputs.begin())), input.plane(k).begin());
  }
  const Image result = filtered(plan, input), expected = reference::nfor(plan, input);
  for (std::size_t i = 0; i < result.data().size(); ++i)
    ASSERT_NEAR(result.data()[i], expected.data()[i], 2e-3 * std::abs(expected.data()[i]) + 1e-5);
}

}  // namespace
}  // namespace tessera
