// SPDX-License-Identifier: Apache-2.0
// How a shadow catcher chooses the way along which it asks for light.
#include "worker/render/catcher.h"

#include <gtest/gtest.h>

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/scenes.h"
#include "worker/render/render_scene.h"

namespace tessera::tracer {
namespace {

using tessera::testing::expect_follows;
using tessera::testing::Random;

constexpr int kTries = 40000;

TEST(Reservoir, KeepsEachInProportionToItsWeight) {
  const std::vector<float> weights{0, 1, 3, 0.5f, 0, 7.5f};
  Random random(71);
  std::vector<Vec2> points;
  for (int i = 0; i < kTries; ++i) {
    Reservoir r(random.number());
    for (std::size_t k = 0; k < weights.size(); ++k)
      r.offer({.direction = {static_cast<float>(k), 0, 0}}, weights[k]);
    points.emplace_back((r.kept()->direction.x + 0.5f) / 6, random.number());
  }
  expect_follows(
      points, kTries, [&](double x, double) { return weights[std::size_t(x * 6)] / 12 * 6; }, "kept", 6, 12);
}

TEST(Reservoir, KeepsNothingWithoutAWeight) {
  Reservoir r(0.5f);
  r.offer({}, 0);
  r.offer({}, std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(r.kept());
}

// By how many of the candidates are of each light: they follow the lights' probabilities p, and each weighs
// its irradiance / p.
std::array<double, 3> expected_shares(const std::array<double, 3>& irradiance,
                                      const std::array<double, 3>& p) {
  std::array<double, 3> shares{};
  const auto factorial = [](int n) { return std::tgamma(n + 1.0); };
  for (int a = 0; a <= kCatcherCandidates; ++a)
    for (int b = 0; a + b <= kCatcherCandidates; ++b) {
      const std::array<int, 3> n{a, b, kCatcherCandidates - a - b};
      double chance = factorial(kCatcherCandidates), sum = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        chance *= std::pow(p[i], n[i]) / factorial(n[i]);
        sum += n[i] * irradiance[i] / p[i];
      }
      for (std::size_t i = 0; i < 3; ++i) shares[i] += chance * n[i] * irradiance[i] / p[i] / sum;
    }
  return shares;
}

TEST(Catcher, ChoosesAmongItsCandidatesByTheirShareOfTheIrradiance) {
  Scene scene;
  scene.points.push_back({{0, 1, 0}, {1, 1, 1}});
  scene.points.push_back({{0, 2, 0}, {2, 2, 2}});
  scene.suns.push_back({.direction = {0, -1, 0}, .irradiance = {0.5f, 0.5f, 0.5f}});
  const auto ready = tessera::testing::prepared(scene);
  const auto which = [](bool infinite, const Vec3& target) {
    return infinite ? 2u : target.y > 1.5f ? 1u : 0u;
  };
  Random random(73);
  std::array<double, 3> p{}, found{};
  for (int i = 0; i < kTries; ++i) {
    const float pick = random.number();
    const LightSample s = ready->lights().sample({0, 0, 0}, {0, 1, 0}, pick, random.pair(), 0);
    p[which(s.infinite, s.target)] = s.pdf;  // one direction each: the probability of the light
    const auto way =
        choose_light_way(ready->lights(), {0, 0, 0}, {0, 1, 0}, 0, [&](int) { return random.pair(); });
    ASSERT_TRUE(way);
    found[which(way->infinite, way->target)] += 1.0 / kTries;
  }
  EXPECT_NEAR(p[0] + p[1] + p[2], 1, 1e-5);
  const auto expected = expected_shares({1, 0.5, 0.5}, p);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(found[i], expected[i], 4 * std::sqrt(expected[i] * (1 - expected[i]) / kTries)) << i;
}

}  // namespace
}  // namespace tessera::tracer
