// SPDX-License-Identifier: Apache-2.0
// What is true of the Feature Distance Filter.
#include <cmath>

#include "tests/reference/references.h"
#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class FeatureDistance : public OnDevice {
 protected:
  // Flat surfaces, evenly lit, free of noise, of colour and albedo `left` and `right` of x = 20.
  static Image halves(const FilterPlan& plan, Aov of, float left, float right) {
    Image input = made_up_input(plan, {0, 0, 40, 30}, "converged");
    const std::vector<Channel> inputs = plan.inputs();
    for (int k = 0; k < input.planes(); ++k)
      for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
          const Channel& c = inputs[static_cast<std::size_t>(k)];
          float v = c.statistic == Statistic::variance_of_mean ? 0 : 0.5f;
          if (c.aov == of && c.statistic == Statistic::mean) v = x < 20 ? left : right;
          if (c.aov == Aov::color && c.statistic == Statistic::mean) v = x < 20 ? 0.0f : 1.0f;
          if (c.statistic == Statistic::samples) v = 20;
          input.at(k, x, y) = v;
        }
    return input;
  }
  // Share of what comes from across the edge at x, if a pixel there has weight w.
  static double share(int x, double w) {
    const int across = 8 - (19 - x);
    return across * w / (17 - across + across * w);
  }
};

TEST_F(FeatureDistance, WeighsByTheWorstFeatureInUnitsOfItsLargest) {
  const FilterPlan plan = parse_filter("fdf");
  // Normals are mapped to 0..1: 0.12 apart they are 0.06 apart. (The prefilter blurs a step of the shading.)
  for (const auto& [of, right] : {std::pair{Aov::albedo, 0.53f}, std::pair{Aov::normal, 0.62f}}) {
    const Image result = filtered(plan, halves(plan, of, 0.5f, right));
    for (int x = 12; x < 20; ++x)
      ASSERT_NEAR(result.at(0, x, 15), share(x, std::exp(-1.0)), 1e-5) << info(of).name << " at " << x;
    EXPECT_EQ(result.at(0, 11, 15), 0);
  }
}

TEST_F(FeatureDistance, ComputesItsFormulasCloselyWhereNothingIsExtreme) {
  for (const std::string_view text : {"fdf", "fdf:radius=3,guides=prefiltered"})
    for (const std::string_view kind : {"noise", "sky", "converged"}) {
      const FilterPlan plan = parse_filter(text);
      const Image input = made_up_input(plan, {0, 0, 36, 28}, kind);
      const Image result = filtered(plan, input), expected = reference::filtered(plan, input);
      for (std::size_t i = 0; i < result.data().size(); ++i)
        ASSERT_NEAR(result.data()[i], expected.data()[i], 1e-4 * std::abs(expected.data()[i]))
            << text << " on " << kind;
    }
}

TEST_F(FeatureDistance, DoesNotDependOnTheUnitOfLight) {
  const FilterPlan plan = parse_filter("fdf:light=1"), scaled = parse_filter("fdf:light=8");
  Image input = made_up_input(plan, {0, 0, 40, 30}, "noise");
  Image expected = filtered(plan, input);
  for (float& v : expected.data()) v *= 8;
  for (int k = 0; k < input.planes(); ++k) {
    const Channel c = plan.inputs()[static_cast<std::size_t>(k)];
    if ((c.aov != Aov::color && c.aov != Aov::shading) || c.statistic == Statistic::samples) continue;
    for (float& v : input.plane(k)) v *= c.statistic == Statistic::mean ? 8 : 64;
  }
  EXPECT_TRUE(same_bits(filtered(scaled, input), expected));
}

}  // namespace
}  // namespace tessera
