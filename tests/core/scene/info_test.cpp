// SPDX-License-Identifier: Apache-2.0
#include "core/scene/info.h"

#include <gmock/gmock.h>

#include "core/scene/limits.h"
#include "tests/core/scene/folder.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(SceneInfo, CountsWhatIsThere) {
  const SceneInfo info = info_of(load_scene(kData / "full.json"));
  EXPECT_EQ(info.triangles, 2u + 1 + 1) << "floor, blade and the spare one";
  EXPECT_EQ(info.instanced_triangles, 2u + 1 + 1) << "floor and two blades";
  EXPECT_EQ(info.vertices, 4u + 3 + 3);
  EXPECT_THAT(info.things,
              ElementsAre(Pair("meshes", 3), Pair("instances", 3), Pair("spheres", 1), Pair("quads", 1),
                          Pair("disks", 1), Pair("objects", 4), Pair("tracks", 2)));
  EXPECT_THAT(info.materials, ElementsAre(Pair("diffuse", 2), Pair("glass", 2), Pair("metal", 2),
                                          Pair("metallic_roughness", 1), Pair("translucent", 1),
                                          Pair("plastic", 1), Pair("mix", 1), Pair("unlit", 1)));
  EXPECT_THAT(info.lights,
              ElementsAre(Pair("point", 1), Pair("spot", 1), Pair("directional", 1), Pair("environment", 1),
                          Pair("emissive triangles", 0), Pair("emissive spheres", 0),
                          Pair("emissive quads", 1), Pair("emissive disks", 1)));
  EXPECT_THAT(info.cameras, ElementsAre("photo", "plan", "around", "ride"));
  EXPECT_THAT(info.variants, ElementsAre("red", "plain"));
  EXPECT_THAT(info.light_groups, ElementsAre("key", "fill"));
}

TEST(SceneInfo, BoundsAreThoseOfAllShapes) {
  const Folder folder;
  const auto bounds = [&](const std::string& shapes) {
    return info_of(load_scene(folder.write("s.json", "{" + shapes + "}"))).bounds;
  };
  const auto quad = bounds(R"("quads": [{"corner": [1, 2, 3], "edge_u": [1, 0, 0], "edge_v": [1, 1, 0]}])");
  EXPECT_EQ(quad.min, Vec3(1, 2, 3));
  EXPECT_EQ(quad.max, Vec3(3, 3, 3));
  const auto disk = bounds(R"("disks": [{"center": [1, 2, 3], "normal": [0, 1, 0], "radius": 2}])");
  EXPECT_EQ(disk.min, Vec3(-1, 2, 1));
  EXPECT_EQ(disk.max, Vec3(3, 2, 5));
  const auto sphere = bounds(R"("spheres": [{"center": [1, 2, 3], "radius": 2}])");
  EXPECT_EQ(sphere.max, Vec3(3, 4, 5));
  EXPECT_TRUE(bounds("").isEmpty());
}

TEST(SceneInfo, MemoryIsWhatTheListsHold) {
  const Folder folder;
  std::filesystem::copy_file(kData / "corners.png", folder.path() / "corners.png");
  const SceneInfo info =
      info_of(load_scene(folder.write("s.json", R"({"environment": {"image": "corners.png"},
    "meshes": {"m": {"positions": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]}}})")));
  ASSERT_EQ(info.memory.size(), 3u);
  EXPECT_EQ(info.memory[0].second, 3 * 3 * sizeof(float) + 3 * sizeof(std::uint32_t));
  ASSERT_EQ(info.pictures.size(), 1u);
  EXPECT_EQ(info.pictures[0].width, 2);
  EXPECT_EQ(info.pictures[0].height, 2);
  EXPECT_EQ(info.pictures[0].channels, 4);
  EXPECT_EQ(info.memory[2].second, info.pictures[0].bytes);
  EXPECT_GT(info.pictures[0].bytes, 0u);
}

TEST(Limits, AreSetByName) {
  ImportLimits limits, expected;
  for (const std::string_view name : limit_names()) set_limit(limits, name, 7);
  expected = {7, 7, 7, 7, 7, 7, 7};
  EXPECT_EQ(limits, expected);
  EXPECT_THROW(set_limit(limits, "vertexes", 1), Error);
}

class LimitedScene : public testing::TestWithParam<std::string> {};

// The scene has exactly what is allowed; one less, and it is refused with the limit's name.
TEST_P(LimitedScene, IsRefusedBeyondItsLimit) {
  const Folder folder;
  std::filesystem::copy_file(kData / "corners.png", folder.path() / "corners.png");
  folder.write("part.json", R"({"spheres": [{"center": [0, 0, 0]}]})");
  const std::string text = R"({"import": [{"file": "part.json"}], "environment": {"image": "corners.png"},
    "meshes": {"m": {"positions": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2], [1,2,0]]}}})";
  const auto file = folder.write("s.json", text);
  const ImportLimits exact{text.size(), 3, 2, 2, 4, 1, 1};
  EXPECT_NO_THROW(load_scene(file, exact));
  for (const auto& [name, value] : {std::pair<std::string, std::uint64_t>{"file_bytes", text.size()},
                                    {"vertices", 3},
                                    {"triangles", 2},
                                    {"instances", 2},
                                    {"picture_pixels", 4},
                                    {"depth", 1}}) {
    if (name != GetParam()) continue;
    ImportLimits less = exact;
    set_limit(less, name, value - 1);
    try {
      load_scene(file, less);
      FAIL() << name;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr("s.json"));
      EXPECT_THAT(e.what(), testing::HasSubstr(name == "file_bytes" ? "bytes" : "limit " + name));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, LimitedScene,
                         testing::Values("file_bytes", "vertices", "triangles", "instances", "picture_pixels",
                                         "depth"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace tessera
