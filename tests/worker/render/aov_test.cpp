// SPDX-License-Identifier: Apache-2.0
// What each AOV holds.
#include <gtest/gtest.h>

#include "tests/worker/render/scenes.h"

namespace tessera {
namespace {

using namespace testing;

constexpr int kEdge = 24;

// All means of a small frame.
struct Means {
  Image sums;
  FilmLayout layout{all_aovs()};
  Vec3 at(Aov aov, int x, int y) const {
    const Image m = developed(sums, layout, channels_of(aov), Part::all);
    Vec3 v(0, 0, 0);
    for (int c = 0; c < std::min(3, m.planes()); ++c) v[c] = m.at(c, x, y);
    return v;
  }
};
Means means(const Scene& scene, int bounces = 3, int samples = 16) {
  const RenderSettings settings{.size = {kEdge, kEdge}, .max_bounces = bounces, .aovs = all_aovs()};
  return {render(*prepared(scene), settings, 0, {0, 0, kEdge, kEdge}, {0, samples}).sums};
}

// A glossy sphere and a lamp on a floor, with sun and sky.
Scene mixed() {
  Scene scene;
  add_floor(scene, Color(0.5f, 0.4f, 0.3f));
  const int glossy =
      add_material(scene, {.kind = Material::Kind::metallic_roughness, .metallic = 0.5f, .roughness = 0.4f});
  const int lamp = add_material(scene, {.emission = Color(3, 2, 1)});
  scene.spheres.push_back({{0, 1, 0}, 1, glossy});
  scene.spheres.push_back({{2, 1.5f, 0}, 0.5f, lamp});
  scene.suns.push_back({Vec3(0.6f, -0.8f, 0), {2, 2, 2}, 0.01f});
  scene.environment.radiance = Color(0.3f, 0.4f, 0.5f);
  scene.cameras = {camera_at({1, 2, 6}, {1, 1, 0}, 0.9f)};
  return scene;
}

TEST(Aov, ColourIsDirectAndIndirectLightAndEmissionInEverySample) {
  const RenderSettings settings{.size = {kEdge, kEdge}, .max_bounces = 3, .aovs = all_aovs()};
  const FilmLayout layout(settings.aovs);
  const Image sums = render(*prepared(mixed()), settings, 0, {0, 0, kEdge, kEdge}, {0, 8}).sums;
  for (const Half half : {Half::a, Half::b})
    for (int c = 0; c < 3; ++c)
      for (int y = 0; y < kEdge; ++y)
        for (int x = 0; x < kEdge; ++x) {
          const auto sum = [&](Aov a) { return sums.at(layout.sum(a, c, half), x, y); };
          const float whole = sum(Aov::color);
          // Each of the sums is of 4 samples and rounded 4 times.
          ASSERT_NEAR(whole, sum(Aov::direct) + sum(Aov::indirect) + sum(Aov::emission),
                      16 * 0x1p-24f * whole);
        }
}

TEST(Aov, CountsAndHitsAreThoseOfEachHalf) {
  const Means m = means(mixed(), 0, 16);
  EXPECT_EQ(m.sums.at(FilmLayout::count(Half::a), 3, 3), 8);
  EXPECT_EQ(m.sums.at(FilmLayout::count(Half::b), 3, 3), 8);
  EXPECT_EQ(m.sums.at(FilmLayout::hits(Half::a), 12, 0), 0) << "sky";
  EXPECT_EQ(m.sums.at(FilmLayout::hits(Half::b), 12, 23), 8) << "floor";
}

TEST(Aov, SquaresAreThoseOfTheSamples) {
  // A lamp that fills the view: every sample is 3, 2, 1.
  Scene scene = mixed();
  scene.cameras = {camera_at({2, 1.5f, 3}, {2, 1.5f, 0}, 0.05f)};
  scene.materials.back().base_color = Color(0, 0, 0);
  const Means m = means(scene);
  EXPECT_EQ(m.sums.at(m.layout.square(Aov::color, 0, Half::b), 5, 5), 8 * 9);
  EXPECT_EQ(m.sums.at(m.layout.square(Aov::direct, 1, Half::a), 5, 5), 0);
  EXPECT_EQ(m.at(Aov::emission, 5, 5), Vec3(3, 2, 1));
  EXPECT_EQ(m.at(Aov::color, 5, 5), Vec3(3, 2, 1));
}

TEST(Aov, OfTheSkyAreItsRadianceAndADistantPoint) {
  Scene scene = mixed();
  scene.cameras = {camera_at({1, 2, 6}, {1, 8, -6}, 0.2f)};
  const Means m = means(scene);
  EXPECT_LT((m.at(Aov::emission, 12, 12) - Vec3(0.3f, 0.4f, 0.5f)).length(), 1e-6f);
  EXPECT_EQ(m.at(Aov::direct, 12, 12), Vec3(0, 0, 0));
  EXPECT_EQ(m.at(Aov::albedo, 12, 12), Vec3(1, 1, 1));
  EXPECT_EQ(m.at(Aov::normal, 12, 12), Vec3(0, 0, 0));
  EXPECT_EQ(m.at(Aov::depth, 12, 12).x, kSkyDepth);
  // As far as the scene is wide: the floor's diagonal, and a bit for its height.
  EXPECT_NEAR((m.at(Aov::position, 12, 12) - Vec3(1, 2, 6)).length(), 200 * std::sqrt(2), 0.1f);
}

TEST(Aov, OfASurfaceAreItsColourNormalPositionAndDepth) {
  Scene scene = mixed();
  scene.cameras = {camera_at({-5, 3, 0}, {-5, 0, -3}, 0.01f)};
  const Means m = means(scene);
  EXPECT_LT((m.at(Aov::albedo, 12, 12) - Vec3(0.5f, 0.4f, 0.3f)).length(), 1e-6f);
  EXPECT_LT((m.at(Aov::normal, 12, 12) - Vec3(0, 1, 0)).length(), 1e-6f);
  EXPECT_LT((m.at(Aov::position, 12, 12) - Vec3(-5, 0, -3)).length(), 5e-3f);
  EXPECT_NEAR(m.at(Aov::depth, 12, 12).x, 3 * std::sqrt(2), 5e-3f);
  EXPECT_EQ(m.at(Aov::emission, 12, 12), Vec3(0, 0, 0));
}

TEST(Aov, NormalsFaceTheCameraOnBothSides) {
  Scene scene;
  add_floor(scene, Color(0.5f, 0.5f, 0.5f));
  scene.cameras = {camera_at({0, -3, 1}, {0, 0, 0}, 0.1f)};
  EXPECT_LT((means(scene).at(Aov::normal, 12, 12) - Vec3(0, -1, 0)).length(), 1e-6f);
}

TEST(Aov, DepthIsMeasuredAlongTheViewAxis) {
  Scene scene;
  add_mesh(scene, grid({-50, -50, -5}, {100, 0, 0}, {0, 100, 0}, 1, add_material(scene, {})));
  scene.cameras = {camera_at({0, 0, 0}, {0, 0, -1}, 1.2f)};
  const Means m = means(scene);
  for (const int x : {0, 11, 23}) EXPECT_NEAR(m.at(Aov::depth, x, 3).x, 5, 1e-4f);
}

TEST(Aov, LightSeenInAMirrorIsDirectAndSurfacesSeenInItAreIndirect) {
  Scene scene;
  const int mirror =
      add_material(scene, {.kind = Material::Kind::mirror, .base_color = Color(0.5f, 0.5f, 0.5f)});
  add_mesh(scene, grid({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, 1, mirror));
  scene.environment.radiance = Color(1, 1, 1);
  scene.cameras = {camera_at({0, 2, 2}, {0, 0, 0}, 0.05f)};
  const Means sky = means(scene);
  EXPECT_NEAR(sky.at(Aov::direct, 9, 9).x, 0.5f, 1e-6f);
  EXPECT_EQ(sky.at(Aov::indirect, 9, 9).x, 0);
  // A white wall where the reflection goes.
  add_mesh(scene, grid({-50, 0, -4}, {100, 0, 0}, {0, 50, 0}, 1, add_material(scene, {})));
  const Means wall = means(scene);
  EXPECT_EQ(wall.at(Aov::direct, 9, 9).x, 0);
  EXPECT_GT(wall.at(Aov::indirect, 9, 9).x, 0.1f);
}

TEST(Aov, DirectLightDoesNotDependOnHowManyBouncesFollow) {
  Scene scene;
  add_floor(scene, Color(0.5f, 0.4f, 0.3f));
  scene.spheres.push_back({{0, 1, 0}, 1, 0});
  scene.environment.radiance = Color(0.3f, 0.4f, 0.5f);
  scene.cameras = {camera_at({1, 2, 6}, {1, 1, 0}, 0.9f)};
  const Measured none = measure(scene, kEdge, 16, 0, Aov::direct);
  for (const int bounces : {1, 2, 4}) {
    const Measured some = measure(scene, kEdge, 16, bounces, Aov::direct);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(some.mean[c], none.mean[c], 1e-5) << bounces;
  }
}

TEST(Aov, MaxBouncesCountsTheScatteringsAfterTheFirstHit) {
  Scene scene = mixed();
  scene.cameras = {camera_at({-5, 3, 0}, {-5, 0, -3}, 0.01f)};
  const Means direct = means(scene, 0);
  EXPECT_EQ(direct.at(Aov::indirect, 3, 3), Vec3(0, 0, 0));
  EXPECT_GT(direct.at(Aov::direct, 3, 3).x, 0);
  // Nothing stands near: the floor sees only sky, so one more bounce brings next to nothing but not nothing
  // under the sphere.
  scene.cameras = {camera_at({0, 0.5f, 3}, {0, 0, 1}, 0.3f)};
  EXPECT_GT(means(scene, 1).at(Aov::indirect, 12, 12).x, 0);
}

// A wall with a chequered mask before a second wall.
TEST(Aov, HolesOfAnAlphaMaskShowWhatIsBehind) {
  Scene scene;
  Picture mask{"mask", 2, 1, 4, {1, 1, 1, 0, 1, 1, 1, 1}};  // left a hole, right solid
  scene.pictures.push_back(mask);
  Material masked{.base_color = Color(0.9f, 0.1f, 0.1f), .alpha = Material::Alpha::mask};
  masked.base_color_texture = {.picture = 0, .wrap_u = Texture::Wrap::clamp, .wrap_v = Texture::Wrap::clamp};
  add_mesh(scene, grid({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, add_material(scene, masked)));
  add_mesh(scene, grid({-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, 1,
                       add_material(scene, {.base_color = Color(0.1f, 0.9f, 0.1f)})));
  scene.points.push_back({{0, 0, 6}, {5, 5, 5}});
  scene.cameras = {camera_at({0, 0, 4}, {0, 0, 0}, 0.3f)};
  const Means m = means(scene);
  EXPECT_LT((m.at(Aov::albedo, 2, 12) - Vec3(0.1f, 0.9f, 0.1f)).length(), 1e-5f);
  EXPECT_LT((m.at(Aov::albedo, 21, 12) - Vec3(0.9f, 0.1f, 0.1f)).length(), 1e-5f);
  EXPECT_NEAR(m.at(Aov::depth, 2, 12).x, 7, 1e-4f);
  // Light, too, falls through the hole (left) and not through the solid half: seen past the wall's edge.
  scene.cameras = {camera_at({0, 5, 3}, {-0.6f, 0, -3}, 0.02f)};
  EXPECT_GT(means(scene, 0).at(Aov::direct, 12, 12).y, 0.01f);
  scene.cameras = {camera_at({0, 5, 3}, {0.6f, 0, -3}, 0.02f)};
  EXPECT_EQ(means(scene, 0).at(Aov::direct, 12, 12).y, 0);
}

}  // namespace
}  // namespace tessera
