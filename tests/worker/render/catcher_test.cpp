// SPDX-License-Identifier: Apache-2.0
// What a shadow catcher finds of the light, against what its ways must give on average.
#include "worker/render/catcher.h"

#include <gtest/gtest.h>

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/scenes.h"
#include "worker/render/render_scene.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;

constexpr int kTries = 40000, kToLights = kLanes / 2;

struct Share {
  double mean, error;
};
// The light that comes through to the origin, which faces up.
Share let_through(const RenderScene& scene) {
  Random random(73);
  double sum = 0, squares = 0;
  for (int i = 0; i < kTries; ++i) {
    const LightWays ways(scene.lights(), {0, 0, 0}, {0, 1, 0}, 0, [&](int) { return random.pair(); });
    const double share = ways.share_let_through(scene.bvh(), {.kind = RayKind::shadow},
                                                [](const Vec3&) { return Vec3(0, 1e-4f, 0); });
    sum += share, squares += share * share;
  }
  const double mean = sum / kTries;
  return {mean, std::sqrt(std::max(0.0, squares / kTries - mean * mean) / kTries)};
}

// By how many of the ways go to each light: they follow the lights' probabilities p, and each stands for its
// irradiance / p.
double expected_share_of_first(const std::array<double, 3>& irradiance, const std::array<double, 3>& p) {
  double share = 0;
  for (int a = 0; a <= kToLights; ++a)
    for (int b = 0; a + b <= kToLights; ++b) {
      const std::array<int, 3> n{a, b, kToLights - a - b};
      double chance = std::tgamma(kToLights + 1.0), sum = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        chance *= std::pow(p[i], n[i]) / std::tgamma(n[i] + 1.0);
        sum += n[i] * irradiance[i] / p[i];
      }
      share += chance * a * irradiance[0] / p[0] / sum;
    }
  return share;
}

Scene three_lights() {
  Scene scene;
  add_material(scene, {});
  scene.points.push_back({{0, 1, 0}, {1, 1, 1}});
  scene.points.push_back({{0, 2, 0}, {2, 2, 2}});
  scene.suns.push_back({.direction = {0, -1, 0}, .irradiance = {0.5f, 0.5f, 0.5f}});
  return scene;
}

TEST(LightWays, AreTheRatioOfTheirEstimates) {
  Scene scene = three_lights();
  add_mesh(scene, grid({-1, 1.5f, -1}, {2, 0, 0}, {0, 0, 2}, 1, 0));  // hides all but the first
  const auto ready = prepared(scene);
  Random random(74);
  std::array<double, 3> p{};
  for (int i = 0; i < 1000; ++i) {
    const float pick = random.number();
    const LightSample s = ready->lights().sample({0, 0, 0}, {0, 1, 0}, pick, random.pair(), 0);
    p[s.infinite ? 2u : s.target.y > 1.5f ? 1u : 0u] = s.pdf;  // one direction: the light's probability
  }
  EXPECT_NEAR(p[0] + p[1] + p[2], 1, 1e-5);
  const Share found = let_through(*ready);
  EXPECT_NEAR(found.mean, expected_share_of_first({1, 0.5, 0.5}, p), 4 * found.error);
}

TEST(LightWays, LetAllThroughWhereNothingIsInBetweenOrShines) {
  EXPECT_EQ(let_through(*prepared(three_lights())).mean, 1);
  EXPECT_EQ(let_through(*prepared(Scene{})).mean, 1);
}

// Of a sky that is the same everywhere, a disc overhead takes r^2 / (r^2 + h^2).
TEST(LightWays, OfASkyAreCosineDistributed) {
  Scene scene;
  add_material(scene, {});
  scene.environment.radiance = Color(2, 2, 2);
  scene.disks.push_back({{0, 1, 0}, {0, -1, 0}, 0.75f, 0});
  const Share found = let_through(*prepared(scene));
  EXPECT_NEAR(found.mean, 1 - 0.5625 / 1.5625, 4 * found.error);
}

}  // namespace
}  // namespace tessera::tracer
