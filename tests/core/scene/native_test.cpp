// SPDX-License-Identifier: Apache-2.0
// Known values from native scene files.
#include "core/scene/load.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/core/scene/folder.h"

namespace tessera {
namespace {

constexpr float kPiF = std::numbers::pi_v<float>;
constexpr float kClose = 1e-6f;

const Material& material(const Scene& scene, std::string_view name) {
  for (const Material& m : scene.materials)
    if (m.name == name) return m;
  throw std::out_of_range(std::string(name));
}

class NativeScene : public testing::Test {
 protected:
  const Scene scene_ = load_scene(kData / "all.json");
};

TEST_F(NativeScene, CamerasLookWhereTheyAreTold) {
  ASSERT_EQ(scene_.cameras.size(), 2u);
  const Camera& main = scene_.cameras[0];
  EXPECT_EQ(main.name, "main");
  EXPECT_TRUE(
      main.to_world.equalWithAbsError(Matrix(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1), kClose));
  EXPECT_FLOAT_EQ(main.horizontal_fov, kPiF / 2);
  EXPECT_EQ(main.vertical_fov, 0);
  EXPECT_FLOAT_EQ(main.lens_radius, 0.01f);
  EXPECT_FLOAT_EQ(main.focus_distance, 5);
  EXPECT_EQ(scene_.cameras[1].to_world.translation(), Vec3(1, 2, 3));
  EXPECT_FLOAT_EQ(scene_.cameras[1].vertical_fov, 40 * kPiF / 180);
  EXPECT_EQ(camera_index(scene_, "side"), 1);
  EXPECT_EQ(camera_index(scene_, ""), 0);
}

TEST_F(NativeScene, LightsHaveTheirPowerAndTheirAnglesInRadians) {
  ASSERT_EQ(scene_.points.size(), 1u);
  EXPECT_EQ(scene_.points[0].intensity, Color(1, 2, 3));
  ASSERT_EQ(scene_.spots.size(), 1u);
  EXPECT_EQ(scene_.spots[0].direction, Vec3(0, -1, 0));
  EXPECT_EQ(scene_.spots[0].intensity, Color(5));
  EXPECT_FLOAT_EQ(scene_.spots[0].inner_angle, 10 * kPiF / 180);
  EXPECT_FLOAT_EQ(scene_.spots[0].outer_angle, 20 * kPiF / 180);
  ASSERT_EQ(scene_.suns.size(), 1u);
  EXPECT_EQ(scene_.suns[0].irradiance, Color(3));
  EXPECT_FLOAT_EQ(scene_.suns[0].angular_diameter, 0.53f * kPiF / 180);
  EXPECT_EQ(scene_.environment.radiance, Color(0.5f));
  EXPECT_FLOAT_EQ(scene_.environment.rotation, kPiF / 2);
  EXPECT_EQ(scene_.pictures[static_cast<std::size_t>(scene_.environment.picture)].width, 2);
}

TEST_F(NativeScene, MaterialsOverrideOnlyTheFieldsTheyGive) {
  for (const Material& m : scene_.materials) {
    if (m.name != "paper") continue;
    EXPECT_EQ(m.base_color, Color(0.25f));
    EXPECT_FALSE(m.normal_texture);
    EXPECT_TRUE(m.base_color_texture);
  }
  EXPECT_FLOAT_EQ(material(scene_, "paper").metallic, 0.125f);
  EXPECT_EQ(material(scene_, "gold").kind, Material::Kind::metal);
  EXPECT_EQ(material(scene_, "gold").k, Color(3.98f, 2.38f, 1.6f));
  EXPECT_EQ(material(scene_, "tiles").base_color_texture.wrap_u, Texture::Wrap::clamp);
  EXPECT_EQ(material(scene_, "tiles").base_color_texture.wrap_v, Texture::Wrap::mirror);
}

TEST_F(NativeScene, QuadsBecomeTwoTrianglesWithTheirAttributes) {
  for (const Mesh& mesh : scene_.meshes) {
    if (mesh.name != "floor") continue;
    using Triangle = std::array<std::uint32_t, 3>;
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(mesh.normals.size(), 4u);
    EXPECT_EQ(mesh.uvs[1], Vec2(1, 1));
    EXPECT_EQ(scene_.materials[static_cast<std::size_t>(mesh.material)].name, "tiles");
    return;
  }
  FAIL() << "no mesh 'floor'";
}

TEST_F(NativeScene, InstancesScaleThenTurnThenMove) {
  // The card's corner (1, 2, 0), twice as large, a quarter turn about Y (x to -z), moved by (1, 0, 0).
  const Instance* turned = nullptr;
  for (const Instance& i : scene_.instances)
    if (i.to_world.translation() == Vec3(1, 0, 0)) turned = &i;
  ASSERT_NE(turned, nullptr);
  EXPECT_TRUE((Vec3(1, 2, 0) * turned->to_world).equalWithAbsError({1, 4, -2}, 1e-5f));
}

TEST_F(NativeScene, ImportsTurnZUpAndLeaveOutWhatTheyAreTold) {
  // The glTF card stands at x = 10; its corner (1, 2, 0) is Z-up's (1, 0, -2), moved by (0, 0, 1).
  bool found = false;
  for (const Instance& i : scene_.instances)
    found |= (Vec3(1, 2, 0) * i.to_world).equalWithAbsError({11, 0, -1}, 1e-5f);
  EXPECT_TRUE(found);
  EXPECT_EQ(scene_.points.size() + scene_.spots.size() + scene_.suns.size(), 3u);
}

TEST_F(NativeScene, WhatHasNoMaterialIsLightGrey) {
  const Material& m = scene_.materials[static_cast<std::size_t>(scene_.spheres[1].material)];
  EXPECT_EQ(m.kind, Material::Kind::diffuse);
  EXPECT_EQ(m.base_color, Color(0.8f));
}

TEST(OurScenes, LoadWithoutAWarning) {
  for (const char* name : {"cornell.json", "furnace.json"}) {
    const Scene scene = load_scene(std::filesystem::path(TESSERA_SOURCE_DIR) / "scenes" / name);
    EXPECT_THAT(scene.warnings, testing::IsEmpty()) << name;
    EXPECT_EQ(scene.cameras.size(), 1u);
  }
}

TEST(OurScenes, TheCornellBoxIsClosedButForItsFront) {
  // The area of the floor, ceiling with lamp, and three walls of the published coordinates, in m^2.
  const Scene scene = load_scene(std::filesystem::path(TESSERA_SOURCE_DIR) / "scenes/cornell.json");
  double area = 0, lamp = 0;
  for (const Mesh& mesh : scene.meshes)
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.positions[t[0]];
      const double half = 0.5 * (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a).length();
      if (!mesh.name.ends_with("block")) area += half;
      if (mesh.name == "lamp") lamp += half;
    }
  const double floor = 0.5592 * (0.5528 + 0.5496) / 2, ceiling = 0.556 * 0.5592,
               back = 0.5488 * (0.5496 + 0.556) / 2, right = 0.5592 * 0.5488;
  const double left = right;  // a little more: it leans
  EXPECT_NEAR(area, floor + ceiling + back + right + left, 1e-4);
  EXPECT_NEAR(lamp, 0.130 * 0.105, 1e-7);
}

TEST(NativeFormat, ASceneWithoutACameraIsFramed) {
  const Folder folder;
  const Scene scene =
      load_scene(folder.write("s.json", R"({"spheres": [{"center": [5, 6, 7], "radius": 2}]})"));
  ASSERT_EQ(scene.cameras.size(), 1u);
  const Vec3 center = Vec3(5, 6, 7) * scene.cameras[0].to_world.inverse();
  EXPECT_NEAR(center.x, 0, 1e-4);
  EXPECT_NEAR(center.y, 0, 1e-4);
  EXPECT_LT(2, -center.z * std::sin(scene.cameras[0].vertical_fov / 2)) << "the sphere is inside the view";
}

TEST(NativeFormat, ScenesImportScenesButNotWithoutEnd) {
  const Folder folder;
  folder.write("ball.json", R"({"spheres": [{"center": [1, 0, 0]}], "environment": {"radiance": 2}})");
  const Scene scene = load_scene(folder.write(
      "s.json", R"({"import": [{"file": "ball.json", "transform": {"scale": 3, "translate": [0, 1, 0]}}]})"));
  EXPECT_EQ(scene.spheres[0].center, Vec3(3, 1, 0));
  EXPECT_FLOAT_EQ(scene.spheres[0].radius, 3);
  EXPECT_EQ(scene.environment.radiance, Color(2));
  EXPECT_THAT(refusal(folder.write("loop.json", R"({"import": [{"file": "loop.json"}]})")),
              testing::HasSubstr("scenes import each other"));
}

}  // namespace
}  // namespace tessera
