// SPDX-License-Identifier: Apache-2.0
// What the guided filter promises.
#include <cmath>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class Guided : public OnDevice {
 protected:
  // Noise without emission on white surfaces, so that colour is illumination.
  static Image white(const FilterPlan& plan, const Region& region) {
    Image input = made_up_input(plan, region, "noise");
    for (int c = 0; c < 3; ++c) {
      std::ranges::fill(input.plane(plane_of(plan, Aov::emission, c)), 0.0f);
      std::ranges::fill(input.plane(plane_of(plan, Aov::albedo, c)), 1.0f);
    }
    return input;
  }
};

TEST_F(Guided, LightThatIsLinearInNormalAndDepthComesBack) {
  const FilterPlan plan = parse_filter("guided:radius=8,epsilon=1e-6,depth_scale=10");
  const Region region{0, 0, 80, 60};
  Image input = white(plan, region);
  for (int y = region.y0; y < region.y1; ++y)
    for (int x = region.x0; x < region.x1; ++x) {
      double n[3], length = 0;
      for (int c = 0; c < 3; ++c) {
        n[c] = input.at(plane_of(plan, Aov::normal, c), x, y);
        length += n[c] * n[c];
      }
      for (double& v : n) v /= std::sqrt(length);
      const double z = input.at(plane_of(plan, Aov::depth, 0), x, y) / 10;
      for (int c = 0; c < 3; ++c)
        input.at(plane_of(plan, Aov::color, c), x, y) =
            static_cast<float>(2 + n[c] - 0.5 * n[(c + 1) % 3] + (c - 1) * z);
    }
  const Image result = filtered(plan, input);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < result.plane(c).size(); ++i)
      ASSERT_NEAR(result.plane(c)[i], input.plane(plane_of(plan, Aov::color, c))[i], 0.01) << c << ", " << i;
}

TEST_F(Guided, OfAVastEpsilonIsAMeanOfMeans) {
  const FilterPlan plan = parse_filter("guided:radius=2,epsilon=1e6,depth_scale=10");
  const Region region{0, 0, 30, 20};
  const Image input = white(plan, region), result = filtered(plan, input);
  const auto mean = [&](const auto& value, int x, int y) {
    double sum = 0;
    const Region window = intersect({x - 2, y - 2, x + 3, y + 3}, region);
    for (int qy = window.y0; qy < window.y1; ++qy)
      for (int qx = window.x0; qx < window.x1; ++qx) sum += value(qx, qy);
    return sum / static_cast<double>(window.area());
  };
  const int red = plane_of(plan, Aov::color, 0);
  const auto noisy = [&](int x, int y) { return double(input.at(red, x, y)); };
  const auto once = [&](int x, int y) { return mean(noisy, x, y); };
  for (int y = region.y0; y < region.y1; ++y)
    for (int x = region.x0; x < region.x1; ++x) ASSERT_NEAR(result.at(0, x, y), mean(once, x, y), 1e-5);
}

TEST_F(Guided, CountsDepthInDiametersOfTheScene) {
  const FilterPlan plan = parse_filter("guided:radius=5");
  const Image input = white(plan, {0, 0, 40, 30});
  const Image known = filtered(resolved(plan, {.diameter = 25}), input),
              unknown = filtered(resolved(plan, {}), input);
  EXPECT_TRUE(same_bits(known, filtered(parse_filter("guided:radius=5,depth_scale=25"), input)));
  EXPECT_TRUE(same_bits(unknown, filtered(parse_filter("guided:radius=5,depth_scale=1"), input)));
  EXPECT_FALSE(same_bits(known, unknown));
}

}  // namespace
}  // namespace tessera
