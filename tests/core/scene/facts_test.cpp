// SPDX-License-Identifier: Apache-2.0
#include "core/scene/facts.h"

#include <gtest/gtest.h>

#include <numbers>

namespace tessera {
namespace {

constexpr double kWhite = 0.2126 + 0.7152 + 0.0722;

Material emitter(float radiance) {
  Material m;
  m.emission = {radiance, radiance, radiance};
  return m;
}

// Spheres of radius 1 about the origin, one of each material.
Scene scene_of(std::vector<Material> materials) {
  Scene scene;
  scene.materials = std::move(materials);
  for (int m = 0; m < static_cast<int>(scene.materials.size()); ++m) scene.spheres.push_back({.material = m});
  return scene;
}

TEST(SceneLight, IsTheMeanLuminanceOfWhatEmits) {
  EXPECT_EQ(facts_of(scene_of({Material{}})).light, 0);
  EXPECT_NEAR(facts_of(scene_of({Material{}, emitter(2), emitter(10)})).light, 6 * kWhite, 1e-6);
  Scene scene = scene_of({Material{}, emitter(2)});
  scene.environment.radiance = {0, 4, 0};
  EXPECT_NEAR(facts_of(scene).light, (2 * kWhite + 4 * 0.7152) / 2, 1e-6);
}

TEST(SceneLight, CountsEachMaterialOnceAndOnlyWhereItIsInUse) {
  Scene scene = scene_of({emitter(2)});
  for (int k = 0; k < 5; ++k) scene.spheres.push_back(scene.spheres[0]);
  scene.materials.push_back(emitter(100));
  EXPECT_NEAR(facts_of(scene).light, 2 * kWhite, 1e-6);
  scene.quads.push_back({.material = 1});
  EXPECT_NEAR(facts_of(scene).light, 51 * kWhite, 1e-5);
}

TEST(SceneLight, OfMixedMaterialsIsTheirMean) {
  Scene scene = scene_of({emitter(1), emitter(5)});
  scene.spheres.resize(1);
  Material mixed;
  mixed.kind = Material::Kind::mix;
  mixed.first = 0;
  mixed.second = 1;
  mixed.mix = 0.25f;
  scene.materials.push_back(mixed);
  scene.spheres[0].material = 2;
  EXPECT_NEAR(facts_of(scene).light, 2 * kWhite, 1e-6);
}

TEST(SceneLight, OfWhatHasNoRadianceIsThatOfWhitePaper) {
  Scene scene = scene_of({Material{}});
  scene.suns.push_back({.irradiance = {3, 3, 3}});
  EXPECT_NEAR(facts_of(scene).light, 3 * kWhite / std::numbers::pi, 1e-6);
  scene.suns.clear();
  scene.points.push_back({.intensity = {6, 6, 6}});
  const double away2 = facts_of(scene).diameter * facts_of(scene).diameter / 4;
  EXPECT_NEAR(away2, 3, 1e-5);
  EXPECT_NEAR(facts_of(scene).light, 6 * kWhite / (std::numbers::pi * away2), 1e-6);
}

TEST(SceneLight, TakesThePlaceOfAZeroInAFilter) {
  const FilterPlan plan = resolved(parse_filter("fdf"), facts_of(scene_of({emitter(2)})));
  EXPECT_NEAR(plan["light"], 2 * kWhite, 1e-6);
  EXPECT_EQ(resolved(parse_filter("fdf:light=7"), {.light = 3})["light"], 7);
}

}  // namespace
}  // namespace tessera
