// SPDX-License-Identifier: Apache-2.0
// Tracks made of the animations of glTF: where things are at known times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/scene/track.h"
#include "tests/core/scene/gltf_builder.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using Json = nlohmann::json;

// As scene.h says: constant outside, interpolated between.
Matrix pose_at(const Track& track, float seconds) {
  const auto next = std::upper_bound(track.times.begin(), track.times.end(), seconds) - track.times.begin();
  if (next == 0) return track.poses.front();
  const auto b = static_cast<std::size_t>(next);
  if (b == track.times.size()) return track.poses.back();
  const float s = (seconds - track.times[b - 1]) / (track.times[b] - track.times[b - 1]);
  return Matrix(between(Imath::M44d(track.poses[b - 1]), Imath::M44d(track.poses[b]), s));
}

// Node 0 has a child, node 1, with a mesh.
class GltfAnimation : public testing::Test {
 protected:
  GltfAnimation() {
    built_.json["scenes"] = {{{"nodes", {0}}}};
    built_.json["nodes"] = {
        {{"name", "parent"}, {"children", {1}}},
        {{"name", "child"}, {"mesh", built_.triangle_mesh()}, {"translation", {2, 0, 0}}}};
  }
  void animate(int node, const char* path, const char* interpolation, const std::vector<float>& times,
               const std::vector<float>& values) {
    const bool turn = std::string(path) == "rotation";
    Json& all = built_.json["animations"];
    if (all.is_null()) all = {{{"channels", Json::array()}, {"samplers", Json::array()}}};
    const int input = built_.accessor(times, "SCALAR"),
              output = built_.accessor(values, turn ? "VEC4" : "VEC3");
    all[0]["channels"].push_back(
        {{"sampler", all[0]["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    all[0]["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  }
  // Where the child's origin is.
  static Vec3 origin(const Scene& scene, float seconds) {
    const Instance& i = scene.instances.at(0);
    const Object& o = scene.objects.at(static_cast<std::size_t>(i.object));
    return (i.to_world * pose_at(scene.tracks.at(static_cast<std::size_t>(o.track)), seconds)).translation();
  }
  GltfBuilder built_;
};

TEST_F(GltfAnimation, ALinearTranslationNeedsItsKeysOnly) {
  animate(1, "translation", "LINEAR", {1, 3}, {0, 0, 0, 8, 0, 0});
  const Scene scene = built_.load();
  ASSERT_THAT(scene.tracks, SizeIs(1));
  EXPECT_THAT(scene.tracks[0].times, ElementsAre(1, 3));
  EXPECT_EQ(origin(scene, 0), Vec3(0)) << "constant before the first key";
  EXPECT_EQ(origin(scene, 2), Vec3(4, 0, 0));
  EXPECT_EQ(origin(scene, 9), Vec3(8, 0, 0));
}

TEST_F(GltfAnimation, WhatHangsBelowANodeThatMovesSharesItsTrack) {
  built_.json["nodes"][0]["children"].push_back(2);
  built_.json["nodes"].push_back({{"mesh", 0}, {"translation", {0, 5, 0}}});
  animate(0, "translation", "LINEAR", {0, 1}, {0, 0, 0, 0, 0, 10});
  const Scene scene = built_.load();
  EXPECT_THAT(scene.tracks, SizeIs(1));
  EXPECT_THAT(scene.objects, SizeIs(2));
  EXPECT_EQ(scene.instances[1].to_world.translation(), Vec3(0, 5, 0));
  EXPECT_EQ(origin(scene, 0.5f), Vec3(2, 0, 5));
}

TEST_F(GltfAnimation, StepsJumpAtTheirKeys) {
  animate(1, "translation", "STEP", {1, 2}, {0, 0, 0, 4, 0, 0});
  const Scene scene = built_.load();
  EXPECT_EQ(origin(scene, 1.999f), Vec3(0));
  EXPECT_EQ(origin(scene, 2), Vec3(4, 0, 0));
}

TEST_F(GltfAnimation, ACubicSplineIsFollowedBetweenItsKeys) {
  // From 0 to 1 with the out-tangent 6 and the in-tangent 0: 6 (s^3 - 2 s^2 + s) + 3 s^2 - 2 s^3.
  animate(1, "translation", "CUBICSPLINE", {0, 1}, {0, 0, 0, 0, 0, 0, 6, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0});
  const Scene scene = built_.load();
  EXPECT_GT(scene.tracks.at(0).times.size(), 8u);
  for (float s = 0; s <= 1; s += 1.0f / 64)
    EXPECT_NEAR(origin(scene, s).x, 6 * (s * s * s - 2 * s * s + s) + 3 * s * s - 2 * s * s * s, 2.5e-3) << s;
}

TEST_F(GltfAnimation, ATurningParentTakesItsChildAlongAnArc) {
  const float h = std::sqrt(0.5f);
  animate(0, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, h, h});  // a quarter turn about Z
  animate(1, "translation", "LINEAR", {0, 1}, {2, 0, 0, 4, 0, 0});     // moving outwards
  const Scene scene = built_.load();
  ASSERT_THAT(scene.tracks, SizeIs(1)) << "the parent shows nothing itself";
  for (float s = 0; s <= 1; s += 1.0f / 64) {
    const float angle = s * 1.57079633f, radius = 2 + 2 * s;
    EXPECT_TRUE(origin(scene, s).equalWithAbsError(Vec3(std::cos(angle), std::sin(angle), 0) * radius, 0.01f))
        << s;
  }
}

TEST_F(GltfAnimation, AConstantTurnNeedsItsKeysOnly) {
  const float h = std::sqrt(0.5f);
  animate(1, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, h, h});
  EXPECT_THAT(built_.load().tracks.at(0).times, ElementsAre(0, 1));
}

TEST_F(GltfAnimation, CamerasMoveWithoutTheScaleAboveThem) {
  built_.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  built_.json["nodes"][1]["camera"] = 0;
  animate(0, "scale", "LINEAR", {0, 1}, {1, 1, 1, 3, 3, 3});
  const Scene scene = built_.load();
  const Camera& camera = scene.cameras.at(0);
  const Matrix last = camera.to_world * scene.tracks.at(static_cast<std::size_t>(camera.track)).poses.back();
  EXPECT_EQ(last.translation(), Vec3(6, 0, 0));
  EXPECT_FLOAT_EQ(Vec3(last[0][0], last[0][1], last[0][2]).length(), 1);
}

TEST_F(GltfAnimation, WhatIsScaledToNothingStaysInvertible) {
  animate(1, "scale", "STEP", {0, 1}, {0, 0, 0, 1, 1, 1});
  const Scene scene = built_.load();
  EXPECT_THAT(scene.tracks.at(0).poses, testing::Not(testing::IsEmpty()));
  for (const Matrix& pose : scene.tracks[0].poses) EXPECT_GT(pose.determinant(), 0);
}

TEST_F(GltfAnimation, LossesAreSaid) {
  built_.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  built_.json["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  built_.json["skins"] = {{{"joints", {0}}}};
  animate(0, "translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0});
  animate(0, "translation", "LINEAR", {0, 1}, {0, 0, 0, 2, 0, 0});
  animate(1, "weights", "LINEAR", {0, 1}, {0, 0, 0, 2, 0, 0});
  animate(1, "extensions", "LINEAR", {0, 1}, {0, 0, 0, 2, 0, 0});
  const Scene scene = built_.load();
  EXPECT_EQ(origin(scene, 1), Vec3(3, 0, 0)) << "the first one is heard";
  for (const char* loss : {"moves the node 'parent' as one before it does", "the light of node 'child' moves",
                           "skins are ignored", "morph targets are ignored", "an animation of 'extensions'"})
    EXPECT_THAT(scene.warnings, Contains(HasSubstr(loss)));
}

TEST_F(GltfAnimation, BrokenOnesAreRefused) {
  const auto refused_with = [&](const char* interpolation, const std::vector<float>& times,
                                const std::vector<float>& values) {
    built_.json.erase("animations");
    animate(0, "translation", interpolation, times, values);
    return built_.refused();
  };
  const std::vector<float> two{0, 0, 0, 1, 0, 0};
  EXPECT_THAT(refused_with("LINEAR", {1, 1}, two),
              HasSubstr("animations/0: time 1 of an animation is 1; accepted: rising"));
  EXPECT_THAT(refused_with("LINEAR", {0, NAN}, two), HasSubstr("time 1 of an animation is nan"));
  EXPECT_THAT(refused_with("LINEAR", {0, 1}, {0, 0, 0, INFINITY, 0, 0}), HasSubstr("is not finite"));
  EXPECT_THAT(refused_with("LINEAR", {0, 1, 2}, two), HasSubstr("has 2 values for 3 times"));
  EXPECT_THAT(refused_with("CUBICSPLINE", {0, 1}, two), HasSubstr("accepted: 3 a time"));
  EXPECT_THAT(refused_with("BEZIER", {0, 1}, two), HasSubstr("the interpolation is 'BEZIER'"));
  built_.json["animations"][0]["samplers"][0]["interpolation"] = "LINEAR";
  built_.json["animations"][0]["channels"][0]["target"]["node"] = 9;
  EXPECT_THAT(built_.refused(), HasSubstr("animations/0: there is no node 9"));
}

TEST(TrackBetween, TakesScaleTurnAndMoveEachOnItsOwn) {
  Imath::M44d a, b;
  a.setScale(Imath::V3d(-1, 1, 1));  // mirrored, as b is
  b = Imath::M44d().setScale(Imath::V3d(-3, 1, 1)) * Imath::M44d().setAxisAngle(Imath::V3d(0, 0, 1), 1.0) *
      Imath::M44d().setTranslation(Imath::V3d(8, 0, 0));
  const Imath::M44d half = between(a, b, 0.5);
  const Imath::M44d expected = Imath::M44d().setScale(Imath::V3d(-2, 1, 1)) *
                               Imath::M44d().setAxisAngle(Imath::V3d(0, 0, 1), 0.5) *
                               Imath::M44d().setTranslation(Imath::V3d(4, 0, 0));
  EXPECT_TRUE(half.equalWithAbsError(expected, 1e-9));
  EXPECT_TRUE(between(a, b, 0).equalWithAbsError(a, 1e-9));
  EXPECT_TRUE(between(a, b, 1).equalWithAbsError(b, 1e-9));
}

}  // namespace
}  // namespace tessera
