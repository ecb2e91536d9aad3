// SPDX-License-Identifier: Apache-2.0
// The tree that picks lights: its probabilities are those of its picks, and no light that matters is left
// out.
#include "worker/render/light/tree.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/worker/render/chi_squared.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;

Vec3 random_direction(Random& random) { return from_square(random.number(), random.number()); }

// Points, spots and little one- and two-sided squares, in clumps; some of no intensity.
std::vector<LightBounds> lamps(Random& random, int count) {
  std::vector<LightBounds> all;
  Vec3 clump(0, 0, 0);
  for (int i = 0; i < count; ++i) {
    if (i % 7 == 0) clump = Vec3(random.number(), random.number(), random.number()) * 20.0f;
    const Vec3 at = clump + random_direction(random) * random.number();
    LightBounds b{.low = at, .high = at, .intensity = i % 11 == 3 ? 0.0f : 0.1f + random.number()};
    if (i % 4 == 1) b.facing = {random_direction(random), 1}, b.cos_reach = 0.8f;
    if (i % 4 >= 2) {
      b.facing = {random_direction(random), 1};
      b.two_sided = i % 4 == 3;
      b.high += Vec3(0.3f, 0.2f, 0.1f);
    }
    all.push_back(b);
  }
  return all;
}

// True if a part of the light shines at p.
bool reaches(const LightBounds& b, const Vec3& p, Random& random) {
  for (int i = 0; i < 8; ++i) {
    Vec3 at;
    for (int k = 0; k < 3; ++k) at[k] = b.low[k] + (b.high[k] - b.low[k]) * random.number();
    float cosine = b.facing.cosine < 0 ? 1 : dot(unit(p - at), b.facing.axis);
    if (b.two_sided) cosine = std::abs(cosine);
    if (cosine > b.cos_reach + 1e-4f) return true;
  }
  return false;
}

TEST(LightTree, EveryLightThatReachesThePointHasAProbability) {
  Random random(41);
  for (const int count : {1, 2, 3, 50, 700}) {
    const std::vector<LightBounds> lights = lamps(random, count);
    const LightTree tree(lights);
    for (int i = 0; i < 40; ++i) {
      const Vec3 p = Vec3(random.number(), random.number(), random.number()) * 22.0f;
      const Vec3 n = random_direction(random);
      double sum = 0;
      for (std::uint32_t l = 0; l < lights.size(); ++l) {
        const float probability = tree.probability(p, n, l);
        sum += probability;
        if (!(lights[l].intensity > 0)) {
          EXPECT_EQ(probability, 0);
        } else if (reaches(lights[l], p, random)) {
          EXPECT_GT(probability, 0) << "light " << l << " of " << count;
        }
      }
      EXPECT_LT(sum, 1 + 1e-4) << count;  // the rest: clusters that may reach the point, and do not
    }
  }
}

TEST(LightTree, ProbabilitiesOfLightsThatShineAllAroundSumToOne) {
  Random random(42);
  for (const int count : {1, 2, 3, 50, 700}) {
    std::vector<LightBounds> lights = lamps(random, count);
    for (LightBounds& b : lights) b.facing.cosine = -1;
    const LightTree tree(lights);
    for (int i = 0; i < 40; ++i) {
      const Vec3 p = Vec3(random.number(), random.number(), random.number()) * 22.0f;
      const Vec3 n = random_direction(random);
      double sum = 0;
      for (std::uint32_t l = 0; l < lights.size(); ++l) sum += tree.probability(p, n, l);
      EXPECT_NEAR(sum, 1, 1e-4) << count;
    }
  }
}

TEST(LightTree, PicksAsOftenAsItSaysAndSaysTheSameBitsEitherWay) {
  Random random(43);
  const std::vector<LightBounds> lights = lamps(random, 200);
  const LightTree tree(lights);
  for (int at = 0; at < 10; ++at) {
    const Vec3 p = Vec3(random.number(), random.number(), random.number()) * 20.0f;
    const Vec3 n = random_direction(random);
    constexpr int kTries = 20000;
    std::vector<int> counts(lights.size());
    double shares = 0;
    int none = 0;
    for (int i = 0; i < kTries; ++i) {
      const LightTree::Pick pick = tree.pick(p, n, (float(i) + 0.5f) / kTries);
      if (!(pick.probability > 0)) {
        ++none;
        continue;
      }
      ASSERT_EQ(pick.probability, tree.probability(p, n, pick.light));
      ASSERT_TRUE(pick.share >= 0 && pick.share < 1);
      ++counts[pick.light];
      shares += pick.share;
    }
    EXPECT_LT(none, kTries);
    double sum = 0;
    for (std::uint32_t l = 0; l < lights.size(); ++l) {
      sum += tree.probability(p, n, l);
      // The numbers that pick a light are an interval: evenly spaced ones miss its length by at most one.
      if (none == 0) {
        EXPECT_NEAR(counts[l], kTries * tree.probability(p, n, l), 1.1);
      }
    }
    EXPECT_NEAR(none, kTries * (1 - sum), 2);
    if (none == 0) {
      EXPECT_NEAR(shares / kTries, 0.5, 0.02);
    }
  }
}

TEST(LightTree, MoreLightsThanItsDepthAllInOnePlaceAreAllPicked) {
  const std::vector<LightBounds> lights(1000,
                                        LightBounds{.low = {1, 1, 1}, .high = {1, 1, 1}, .intensity = 2});
  const LightTree tree(lights);
  for (std::uint32_t l = 0; l < lights.size(); ++l)
    EXPECT_NEAR(tree.probability({0, 0, 0}, {0, 1, 0}, l), 1e-3, 3e-4);
  // A row in which each is far nearer to the next than to the one before: the most lopsided tree.
  std::vector<LightBounds> row;
  float x = 1e30f;
  for (int i = 0; i < 90; ++i, x /= 4) row.push_back({.low = {x, 0, 0}, .high = {x, 0, 0}, .intensity = 1});
  const LightTree chain(row);
  double sum = 0;
  for (std::uint32_t l = 0; l < row.size(); ++l) sum += chain.probability({0, 1, 0}, {0, 1, 0}, l);
  EXPECT_NEAR(sum, 1, 1e-4);
}

TEST(LightTree, IsEmptyWhereNothingShines) {
  EXPECT_EQ(LightTree().pick({0, 0, 0}, {0, 1, 0}, 0.3f).probability, 0);
  const std::vector<LightBounds> dark(3);
  EXPECT_EQ(LightTree(dark).pick({0, 0, 0}, {0, 1, 0}, 0.3f).probability, 0);
  EXPECT_EQ(LightTree(dark).probability({0, 0, 0}, {0, 1, 0}, 1), 0);
}

TEST(LightTree, LightsAtNoPlaceOrWithoutADirectionDoNotSpoilTheRest) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN(),
                  kInfinite = std::numeric_limits<float>::infinity();
  std::vector<LightBounds> lights(6, LightBounds{.low = {0, 1, 0}, .high = {0, 1, 0}, .intensity = 1});
  lights[1].low.x = kNone;
  lights[2].high.y = kInfinite;
  lights[3].facing = {{kNone, kNone, kNone}, 1};
  lights[4].low = {-3e38f, 0, 3e38f};
  lights[4].high = {0, 3e38f, 3e38f};
  const LightTree tree(lights);
  double sum = 0;
  for (std::uint32_t l = 0; l < lights.size(); ++l) sum += tree.probability({0, 0, 0}, {0, 1, 0}, l);
  EXPECT_NEAR(sum, 1, 1e-5);
  for (const std::uint32_t l : {0u, 3u, 5u}) EXPECT_GT(tree.probability({0, 0, 0}, {0, 1, 0}, l), 0.1f);
}

TEST(LightTree, ConesHoldBothOfTheirParts) {
  Random random(47);
  for (int i = 0; i < 2000; ++i) {
    const Cone a{random_direction(random), 2 * random.number() - 1},
        b{random_direction(random), 2 * random.number() - 1};
    const Cone both = joined(a, b);
    for (const Cone& c : {a, b}) {
      // A direction at the rim of the part, away from the whole's axis.
      const Vec3 side = c.axis - both.axis * dot(c.axis, both.axis);
      if (!(dot(side, side) > 1e-6f)) continue;
      const float apart = std::acos(std::clamp(dot(c.axis, both.axis), -1.0f, 1.0f));
      if (both.cosine <= -1) continue;
      EXPECT_LE(apart + std::acos(c.cosine), std::acos(both.cosine) + 2e-3f);
    }
    EXPECT_NEAR(length(both.axis), 1, 1e-5f);
  }
}

}  // namespace
}  // namespace tessera::tracer
