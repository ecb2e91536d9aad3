// SPDX-License-Identifier: Apache-2.0
// What finishing refuses, leaves out and pulls into range.
#include "core/scene/finish.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/error.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// One of everything, all of it good.
Scene good() {
  Scene scene;
  scene.pictures.push_back({"p", 1, 1, 1, {}});
  scene.materials.resize(2);
  scene.materials[0].name = "m";
  scene.meshes.resize(1);
  scene.meshes[0].name = "t";
  scene.meshes[0].positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.meshes[0].triangles = {{0, 1, 2}};
  scene.light_groups = {"key"};
  scene.tracks.push_back({{0, 1}, {Matrix(), Matrix()}});
  scene.objects.emplace_back().name = "o";
  scene.instances = {{0, Matrix(), 0}};
  scene.spheres.emplace_back();
  scene.quads.emplace_back();
  scene.disks.emplace_back();
  scene.points.emplace_back();
  scene.spots.emplace_back();
  scene.suns.emplace_back();
  scene.cameras.emplace_back().name = "c";
  scene.variants = {{"v", {{0, 1}}}};
  return scene;
}

std::string refused(const std::function<void(Scene&)>& spoil) {
  Scene scene = good();
  spoil(scene);
  try {
    finish(scene, "f");
  } catch (const InputError& e) {
    return e.what();
  }
  return "finished";
}

Scene finished(const std::function<void(Scene&)>& change) {
  Scene scene = good();
  change(scene);
  finish(scene, "f");
  return scene;
}

TEST(Finish, LeavesAGoodSceneAsItIs) {
  const Scene scene = finished([](Scene&) {});
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(scene.spheres.size() + scene.quads.size() + scene.disks.size(), 3u);
  EXPECT_EQ(scene.points.size() + scene.spots.size() + scene.suns.size(), 3u);
}

TEST(Finish, RefusesIndicesThatPointNowhere) {
  EXPECT_EQ(refused([](Scene& s) { s.meshes[0].material = 2; }),
            "f: mesh 't': there is no material 2; accepted: below 2");
  EXPECT_THAT(refused([](Scene& s) { s.meshes[0].triangles[0][1] = 3; }),
              HasSubstr("mesh 't' uses vertex 3 of 3"));
  EXPECT_THAT(refused([](Scene& s) { s.instances[0].mesh = -1; }), HasSubstr("there is no mesh -1"));
  EXPECT_THAT(refused([](Scene& s) { s.instances[0].object = 1; }), HasSubstr("there is no object 1"));
  EXPECT_THAT(refused([](Scene& s) { s.objects[0].track = 1; }),
              HasSubstr("object 'o': there is no track 1"));
  EXPECT_THAT(refused([](Scene& s) { s.objects[0].light.group = 1; }),
              HasSubstr("there is no light group 1"));
  EXPECT_THAT(refused([](Scene& s) { s.suns[0].light.group = -2; }), HasSubstr("there is no light group -2"));
  EXPECT_THAT(refused([](Scene& s) { s.quads[0].material = 9; }),
              HasSubstr("a quad: there is no material 9"));
  EXPECT_THAT(refused([](Scene& s) { s.disks[0].object = 9; }), HasSubstr("a disk: there is no object 9"));
  EXPECT_THAT(refused([](Scene& s) { s.materials[0].sheen_color_texture.picture = 1; }),
              HasSubstr("there is no picture 1"));
  EXPECT_THAT(refused([](Scene& s) { s.environment.picture = 1; }),
              HasSubstr("the environment: there is no picture 1"));
  EXPECT_THAT(refused([](Scene& s) { s.cameras[0].track = 1; }),
              HasSubstr("camera 'c': there is no track 1"));
  EXPECT_THAT(refused([](Scene& s) { s.variants[0].choices[0].mesh = 1; }),
              HasSubstr("variant 'v': there is no mesh 1"));
}

TEST(Finish, RefusesListsThatDoNotGoTogether) {
  EXPECT_THAT(refused([](Scene& s) { s.meshes[0].uvs2.resize(2); }), HasSubstr("a list of 2 for 3 vertices"));
  EXPECT_THAT(refused([](Scene& s) { s.meshes[0].colors.resize(4); }),
              HasSubstr("a list of 4 for 3 vertices"));
  EXPECT_THAT(refused([](Scene& s) { s.tracks[0].times.pop_back(); }),
              HasSubstr("track 0 has 1 times and 2 poses"));
  EXPECT_THAT(refused([](Scene& s) { s.tracks[0] = {}; }), HasSubstr("track 0 has 0 times and 0 poses"));
  EXPECT_THAT(refused([](Scene& s) {
                s.tracks[0].times = {1, 1};
              }),
              HasSubstr("time 1 is 1; accepted: rising times"));
  EXPECT_THAT(refused([](Scene& s) { s.tracks[0].times[0] = kNan; }), HasSubstr("time 0 is nan"));
  EXPECT_THAT(refused([](Scene& s) { s.tracks[0].poses[1].setScale(0.0f); }),
              HasSubstr("pose 1 is not finite or flat"));
  EXPECT_THAT(refused([](Scene& s) { s.light_groups.resize(9); }),
              HasSubstr("there are 9 light groups; accepted: at most 8"));
  EXPECT_THAT(refused([](Scene& s) { s.frames_per_second = 0; }), HasSubstr("0 frames a second"));
}

// Materials 0 to `levels` - 1 are mixes of the next one with itself.
void mix_deeply(Scene& scene, int levels) {
  scene.materials.resize(static_cast<std::size_t>(levels) + 1);
  for (int m = 0; m < levels; ++m) {
    Material& mix = scene.materials[static_cast<std::size_t>(m)];
    mix.kind = Material::Kind::mix;
    mix.first = mix.second = m + 1;
  }
  scene.variants.clear();
}

TEST(Finish, RefusesMixesThatNeverEndOrAreTooDeep) {
  EXPECT_EQ(refused([](Scene& s) { mix_deeply(s, kMaxMixDepth); }), "finished");
  EXPECT_THAT(
      refused([](Scene& s) { mix_deeply(s, kMaxMixDepth + 1); }),
      HasSubstr("the material 'm' mixes materials in a circle or too deeply; accepted: at most 3 levels"));
  EXPECT_THAT(refused([](Scene& s) {
                mix_deeply(s, 2);
                s.materials[1].second = 0;
              }),
              HasSubstr("in a circle"));
  EXPECT_THAT(refused([](Scene& s) {
                mix_deeply(s, 1);
                s.materials[0].first = -1;
              }),
              HasSubstr("there is no material -1"));
}

TEST(Finish, RefusesCamerasThatSeeNothing) {
  EXPECT_THAT(refused([](Scene& s) { s.cameras[0].vertical_fov = 4; }),
              HasSubstr("camera 'c': the field of view is 4"));
  EXPECT_THAT(refused([](Scene& s) {
                s.cameras[0].projection = Camera::Projection::orthographic;
                s.cameras[0].height = -1;
              }),
              HasSubstr("camera 'c': it sees -1 metres"));
}

TEST(Finish, PullsNumbersIntoTheirRangesInWords) {
  const Scene scene = finished([](Scene& s) {
    s.materials[0].clearcoat = 2;
    s.materials[0].sheen_color = {-1, 0.5f, kNan};
    s.materials[0].attenuation_distance = -3;
    s.suns[0].angular_diameter = 7;
    s.objects[0].light.diffuse = -1;
    s.cameras[0].shutter_open = 0.5f;
    s.cameras[0].shutter_close = 0.25f;
    s.meshes[0].colors = {{2, 0.5f, kNan, 1}, {1, 1, 1, 1}, {0, 0, 0, 0}};
  });
  EXPECT_EQ(scene.materials[0].clearcoat, 1);
  EXPECT_EQ(scene.materials[0].sheen_color, Color(0, 0.5f, 0));
  EXPECT_EQ(scene.materials[0].attenuation_distance, 0);
  EXPECT_LT(scene.suns[0].angular_diameter, 3.15f);
  EXPECT_EQ(scene.objects[0].light.diffuse, 0);
  EXPECT_EQ(scene.cameras[0].shutter_close, 0.5f);
  EXPECT_EQ(scene.meshes[0].colors[0], (std::array<float, 4>{1, 0.5f, 1, 1}));
  EXPECT_THAT(scene.warnings, Contains("f: material 'm': clearcoat 2 is taken for 1"));
  EXPECT_THAT(scene.warnings, Contains("f: mesh 't': 1 vertex colours beyond 0..1 are pulled into it"));
}

TEST(Finish, ATranslucentSheetSendsOnNoMoreThanItGets) {
  const Scene scene = finished([](Scene& s) {
    s.materials[0].kind = Material::Kind::translucent;
    s.materials[0].base_color = Color(0.75f);
    s.materials[0].transmission_color = Color(0.75f, 0.25f, 0);
  });
  EXPECT_EQ(scene.materials[0].base_color, Color(0.5f, 0.75f, 0.75f));
  EXPECT_EQ(scene.materials[0].transmission_color, Color(0.5f, 0.25f, 0));
  EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(Finish, LeavesOutShapesWithoutSize) {
  const Scene scene = finished([](Scene& s) {
    s.quads[0].edge_v = s.quads[0].edge_u;
    s.disks[0].normal = {0, 2, 0};
    s.spheres[0].center.x = kNan;
  });
  EXPECT_EQ(scene.quads.size() + scene.disks.size() + scene.spheres.size(), 0u);
  EXPECT_EQ(scene.warnings.size(), 3u);
}

TEST(Finish, FramesWhatMovesWhereItBegins) {
  const auto eye = [](const Scene& scene) { return scene.cameras[0].to_world.translation(); };
  const auto alone = [](Scene& s) { s.cameras.clear(), s.spheres.clear(), s.quads.clear(), s.disks.clear(); };
  const Scene resting = finished(alone), moving = finished([&](Scene&s) {
                                           alone(s);
                                           s.tracks[0].poses[0].setTranslation(Vec3(100, 0, 0));
                                           s.objects[0].track = 0;
                                         });
  EXPECT_TRUE((eye(moving) - eye(resting)).equalWithAbsError(Vec3(100, 0, 0), 1e-4f));
}

}  // namespace
}  // namespace tessera
