// SPDX-License-Identifier: Apache-2.0
// What a sample tells besides its light: features for filters, motion, and mattes.
#include <gtest/gtest.h>

#include <numeric>

#include "core/cryptomatte.h"
#include "tests/worker/render/scenes.h"

namespace tessera {
namespace {

using namespace testing;

constexpr int kEdge = 16;

class Rendered {
 public:
  Rendered(const Scene& scene, AovSet aovs, int bounces = 3, int samples = 16, int frame = 0)
      : layout_(aovs) {
    const RenderSettings settings{.size = {kEdge, kEdge}, .max_bounces = bounces, .aovs = aovs};
    const auto shared = std::make_shared<const Scene>(scene);
    sums_ =
        render(*prepare(shared, settings, frame), settings, frame, {0, 0, kEdge, kEdge}, {0, samples}).sums;
  }
  float at(Aov aov, int channel, int x, int y, Statistic statistic = Statistic::mean,
           Part part = Part::all) const {
    const Channel wanted{aov, channel, statistic};
    return developed(sums_, layout_, {&wanted, 1}, part).at(0, x, y);
  }
  Vec3 color(Aov aov, int x, int y) const { return {at(aov, 0, x, y), at(aov, 1, x, y), at(aov, 2, x, y)}; }
  const Image& sums() const { return sums_; }
  const FilmLayout& layout() const { return layout_; }

 private:
  FilmLayout layout_;
  Image sums_;
};

Material painted(const Color& color) { return {.name = "paint", .base_color = color}; }

// A wall at z = -5 that fills the view of a camera in the origin.
Scene wall(const Material& material) {
  Scene scene;
  add_mesh(scene, grid({-50, -50, -5}, {100, 0, 0}, {0, 100, 0}, 1, add_material(scene, material)));
  scene.environment.radiance = Color(1, 1, 1);
  scene.cameras = {camera_at({0, 0, 0}, {0, 0, -1}, 1.0f)};
  return scene;
}

TEST(Guides, Texture2IsTheDiffuseSurfaceSeenInAMirror) {
  Scene scene = wall({.kind = Material::Kind::mirror, .base_color = Color(1, 1, 1)});
  add_mesh(scene, grid({50, -50, 3}, {-100, 0, 0}, {0, 100, 0}, 1,
                       add_material(scene, painted({0.2f, 0.4f, 0.6f}))));
  const Rendered r(scene, {Aov::texture2});
  EXPECT_LT((r.color(Aov::texture2, 8, 8) - Vec3(0.2f, 0.4f, 0.6f)).length(), 1e-5f);
  scene.instances.pop_back();
  EXPECT_EQ(Rendered(scene, {Aov::texture2}).color(Aov::texture2, 8, 8), Vec3(0, 0, 0));
}

TEST(Guides, TheBounceIsTheUnitDirectionInWhichThePathLeft) {
  const Rendered mirror(wall({.kind = Material::Kind::mirror}), {Aov::bounce}, 1, 8);
  const Vec3 d = mirror.color(Aov::bounce, 8, 8);
  EXPECT_NEAR(d.length(), 1, 1e-3f);
  EXPECT_GT(d.z, 0.9f);
  // Of a diffuse surface: the mean of a cosine lobe is 2/3 of the normal.
  const Rendered diffuse(wall(painted({1, 1, 1})), {Aov::bounce}, 1, 256);
  const Vec3 mean = diffuse.color(Aov::bounce, 3, 3);
  EXPECT_LT((mean - Vec3(0, 0, 2.0f / 3)).length(), 0.1f);
  EXPECT_GT(diffuse.at(Aov::bounce, 2, 3, 3, Statistic::variance_of_mean), 0);
}

TEST(Guides, ShadingIsWhatEmittersSentWhateverTheSurfaceMadeOfIt) {
  for (const float albedo : {0.1f, 0.9f}) {
    const Rendered r(wall(painted({albedo, albedo, albedo})), {Aov::shading}, 0, 16);
    // One vertex, which sees a sky of 1 in every direction.
    EXPECT_NEAR(r.at(Aov::shading, 0, 5, 5), 1, 1e-5f) << albedo;
  }
}

TEST(Guides, HistogramsCountEverySampleOnceAChannel) {
  const Rendered r(wall(painted({0.5f, 0.5f, 0.5f})), {Aov::color, Aov::histogram}, 1, 32);
  for (int channel = 0; channel < 3; ++channel)
    for (const int half : {0, 1}) {
      float sum = 0;
      for (int b = 0; b < kHistogramBins; ++b)
        sum += r.sums().at(
            r.layout().sum(Aov::histogram, channel * kHistogramBins + b, static_cast<Half>(half)), 4, 4);
      EXPECT_EQ(sum, 16);
    }
  // Radiance 0.5 everywhere.
  const int bin = histogram_bin(0.5f);
  EXPECT_EQ(r.sums().at(r.layout().sum(Aov::histogram, bin, Half::a), 4, 4), 16);
}

TEST(Guides, PointSampledIdsNormalsAndSlopesHaveNoNoise) {
  Scene scene;
  scene.objects = {{.name = "ground"}};
  add_floor(scene, {0.5f, 0.5f, 0.5f});
  scene.instances[0].object = 0;
  scene.cameras = {camera_at({0, 1, 0}, {0, 0, -1}, 1.0f)};
  const AovSet aovs{Aov::object_id,      Aov::material_id, Aov::geometric_normal,
                    Aov::depth_gradient, Aov::motion,      Aov::previous_depth};
  const Rendered few(scene, aovs, 0, 8), many(scene, aovs, 0, 64);
  EXPECT_EQ(few.at(Aov::object_id, 0, 8, 8), 1);
  EXPECT_EQ(few.at(Aov::material_id, 0, 8, 8), 1);
  EXPECT_EQ(few.color(Aov::geometric_normal, 8, 8), Vec3(0, 1, 0));
  EXPECT_EQ(few.at(Aov::motion, 0, 8, 8), 0);
  EXPECT_EQ(few.at(Aov::motion, 1, 8, 8), 0);
  for (const Aov a : {Aov::depth_gradient, Aov::previous_depth})
    EXPECT_EQ(few.at(a, 0, 3, 9), many.at(a, 0, 3, 9)) << "as it was with fewer samples";
  // The floor's depth grows upwards in the picture; its slope is that between the pixels' own depths.
  const float slope = few.at(Aov::depth_gradient, 1, 8, 12);
  const float above = few.at(Aov::previous_depth, 0, 8, 11), below = few.at(Aov::previous_depth, 0, 8, 13);
  EXPECT_LT(slope, 0);
  EXPECT_NEAR(slope, (below - above) / 2, 0.02f * std::abs(slope));
  EXPECT_NEAR(few.at(Aov::depth_gradient, 0, 8, 12), 0, 1e-5f);
}

TEST(Guides, MotionFollowsACameraOnATrack) {
  Scene scene = wall(painted({0.5f, 0.5f, 0.5f}));
  scene.frames_per_second = 10;
  scene.tracks = {{{0, 1}, {Matrix(), Matrix().translate(Vec3(1, 0, 0))}}};  // 0.1 m a frame to the right
  scene.cameras[0].track = 0;
  const Rendered r(scene, {Aov::motion, Aov::previous_depth}, 0, 8, 5);
  const float pixels = 0.1f / 5 / (2 * std::tan(0.5f) / kEdge);
  EXPECT_NEAR(r.at(Aov::motion, 0, 6, 9), -pixels, 1e-3f) << "what the camera passes goes to the left";
  EXPECT_NEAR(r.at(Aov::motion, 1, 6, 9), 0, 1e-3f);
  EXPECT_NEAR(r.at(Aov::previous_depth, 0, 6, 9), 5, 1e-4f);
}

TEST(Guides, NextMotionLeadsToWhereTheNextFrameCameFrom) {
  Scene scene = wall(painted({0.5f, 0.5f, 0.5f}));
  scene.frames_per_second = 10;
  // Unevenly, so that before and after differ: 0.1 m to the right, then 0.2 m up and 1 m ahead.
  scene.tracks = {
      {{0, 0.1f, 0.2f},
       {Matrix(), Matrix().translate(Vec3(0.1f, 0, 0)), Matrix().translate(Vec3(0.1f, 0.2f, -1))}}};
  scene.cameras[0].track = 0;
  const AovSet aovs{Aov::motion, Aov::previous_depth, Aov::next_motion, Aov::next_depth};
  const Rendered now(scene, aovs, 0, 8, 1);
  const float slope = 2 * std::tan(0.5f) / kEdge;  // a pixel's, at depth 1
  EXPECT_NEAR(now.at(Aov::motion, 0, 6, 9), -0.1f / 5 / slope, 1e-3f);
  EXPECT_NEAR(now.at(Aov::motion, 1, 6, 9), 0, 1e-3f);
  EXPECT_NEAR(now.at(Aov::next_depth, 0, 6, 9), 4, 1e-4f);
  // The point at depth 5 through pixel (6.5, 9.5) is seen from 0.2 m higher, at depth 4.
  const float x = (6.5f - kEdge / 2) * slope * 5, y = (9.5f - kEdge / 2) * slope * 5 + 0.2f;
  EXPECT_NEAR(now.at(Aov::next_motion, 0, 6, 9), x / 4 / slope + kEdge / 2 - 6.5f, 1e-3f);
  EXPECT_NEAR(now.at(Aov::next_motion, 1, 6, 9), y / 4 / slope + kEdge / 2 - 9.5f, 1e-3f);
}

TEST(Guides, NextMotionFollowsAnObjectThatMovesAsItsMotionWillHaveBeen) {
  Scene scene = wall(painted({0.5f, 0.5f, 0.5f}));
  scene.frames_per_second = 1;
  scene.objects = {{.name = "wall", .track = 0}};
  scene.instances[0].object = 0;
  scene.tracks = {{{0, 2}, {Matrix(), Matrix().translate(Vec3(1, -0.5f, 0))}}};  // at an even pace
  const AovSet aovs{Aov::motion, Aov::previous_depth, Aov::next_motion, Aov::next_depth};
  const Rendered r(scene, aovs, 0, 8, 1);
  EXPECT_GT(r.at(Aov::next_motion, 0, 6, 9), 0.2f) << "to the right";
  EXPECT_GT(r.at(Aov::next_motion, 1, 6, 9), 0.1f) << "down";
  for (const int c : {0, 1})
    EXPECT_NEAR(r.at(Aov::next_motion, c, 6, 9), r.at(Aov::motion, c, 6, 9), 1e-4f) << "as before";
  EXPECT_NEAR(r.at(Aov::next_depth, 0, 6, 9), r.at(Aov::previous_depth, 0, 6, 9), 1e-5f);
}

TEST(Guides, WhatRestsStaysWhereItIsAndTheSkyIsFar) {
  Scene scene;
  add_floor(scene, {0.5f, 0.5f, 0.5f});
  scene.cameras = {camera_at({0, 1, 0}, {0, 1, -1}, 1.0f)};
  const AovSet aovs{Aov::next_motion, Aov::next_depth};
  const Rendered r(scene, aovs, 0, 8);
  for (const int y : {2, 12})
    for (const int c : {0, 1}) EXPECT_EQ(r.at(Aov::next_motion, c, 5, y), 0) << y;
  EXPECT_EQ(r.at(Aov::next_depth, 0, 5, 2), kSkyDepth);
  EXPECT_LT(r.at(Aov::next_depth, 0, 5, 14), 10);
}

TEST(Guides, TheSkyMovesOnlyWhenTheCameraTurns) {
  Scene scene = wall(painted({0.5f, 0.5f, 0.5f}));
  scene.instances.clear();
  scene.frames_per_second = 1;
  scene.tracks = {{{0, 1}, {Matrix(), Matrix().translate(Vec3(7, 0, 0))}}};
  scene.cameras[0].track = 0;
  EXPECT_NEAR(Rendered(scene, {Aov::motion}, 0, 8, 1).at(Aov::motion, 0, 6, 9), 0, 1e-4f);
}

TEST(Guides, MattesSayHowMuchOfAPixelEachObjectCovers) {
  Scene scene = wall(painted({0.5f, 0.5f, 0.5f}));
  scene.objects = {{.name = "back"}, {.name = "left"}};
  scene.instances[0].object = 0;
  // Covers the left 8.5 of 16 pixels.
  const float unit = 2 * std::tan(0.5f) / kEdge * 4;
  add_mesh(scene, grid({-9, -9, -4}, {9 + 0.5f * unit, 0, 0}, {0, 18, 0}, 1, 0));
  scene.instances[1].object = 1;
  const Rendered r(scene, {Aov::object_matte, Aov::material_matte}, 0, 64);
  const Image objects = matte(r.sums(), r.layout(), Aov::object_matte);
  EXPECT_EQ(objects.at(0, 3, 3), matte_id("left"));
  EXPECT_EQ(objects.at(1, 3, 3), 1);
  EXPECT_EQ(objects.at(0, 12, 3), matte_id("back"));
  EXPECT_NEAR(objects.at(1, 8, 3), 0.5f, 1.0f / 16) << "stratified in two halves of 32";
  EXPECT_NEAR(objects.at(1, 8, 3) + objects.at(3, 8, 3), 1, 1e-6f);
  EXPECT_EQ(matte(r.sums(), r.layout(), Aov::material_matte).at(0, 8, 3), matte_id("paint"));
}

TEST(Guides, SampleVectorsAreTheFirstSamplesOneByOne) {
  const AovSet aovs{Aov::color, Aov::position, Aov::sample_vectors};
  const Rendered r(wall(painted({0.5f, 0.25f, 0.1f})), aovs, 1, kLeafSamples);
  // The mean of their parts is what the film has summed.
  for (int c = 0; c < 3; ++c) {
    float position = 0, screen = 0;
    for (int s = 0; s < kLeafSamples; ++s) {
      const auto part = static_cast<Part>(s % 2);
      const int first = s / 2 * SampleVector::size;
      position += r.at(Aov::sample_vectors, first + SampleVector::position + c, 7, 7, Statistic::mean, part);
      screen = r.at(Aov::sample_vectors, first + SampleVector::screen, 7, 7, Statistic::mean, part);
      EXPECT_GE(screen, 7);
      EXPECT_LT(screen, 8);
    }
    EXPECT_NEAR(position / kLeafSamples, r.at(Aov::position, c, 7, 7), 1e-4f);
  }
}

TEST(Guides, LightGroupsAddUpToTheWhole) {
  Scene scene = wall(painted({0.5f, 0.25f, 0.1f}));
  scene.light_groups = {"sky", "key"};
  scene.environment.light.group = 0;
  scene.points.push_back({.position = {0, 2, -2}, .intensity = {3, 2, 1}, .light = {.group = 1}});
  const AovSet aovs{Aov::color, light_group_aov(0), light_group_aov(1)};
  const Rendered r(scene, aovs, 2, 32);
  for (int c = 0; c < 3; ++c) {
    const float sky = r.at(light_group_aov(0), c, 4, 11), key = r.at(light_group_aov(1), c, 4, 11);
    EXPECT_GT(sky, 0);
    EXPECT_GT(key, 0);
    EXPECT_NEAR(sky + key, r.at(Aov::color, c, 4, 11), 1e-5f);
  }
}

}  // namespace
}  // namespace tessera
