// SPDX-License-Identifier: Apache-2.0
// What is left of meshes that cannot be rendered as they are.
#include "core/scene/tidy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/scene/finish.h"

namespace tessera {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

Mesh mesh_of(std::vector<Vec3> positions, std::vector<std::array<std::uint32_t, 3>> triangles) {
  Mesh mesh;
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  return mesh;
}

TEST(Tidy, TrianglesWithoutAnAreaAreDroppedAndThinOnesKept) {
  Mesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1e-20f, 0}},
                      {{0, 1, 3}, {0, 1, 2}, {0, 0, 1}, {3, 3, 3}, {0, 4, 2}});
  const Tidied tidied = tidy(mesh);
  EXPECT_EQ(tidied.degenerate, 3u);
  EXPECT_EQ(tidied.not_finite, 0u);
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 3}, {0, 4, 2}}));
}

TEST(Tidy, TrianglesThatAreNotFiniteAreDroppedAndNoNumberIsLeftSo) {
  Mesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {kNan, 0, 0}, {0, kInf, 0}, {0, 0, 1e30f}},
                      {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 1, 5}});
  mesh.uvs.assign(6, Vec2(kNan, kInf));
  EXPECT_EQ(tidy(mesh).not_finite, 3u);
  EXPECT_EQ(mesh.triangles.size(), 1u);
  for (const Vec3& p : mesh.positions) EXPECT_TRUE(std::isfinite(p.length()));
  for (const Vec2& uv : mesh.uvs) EXPECT_EQ(uv, Vec2(0, 0));
}

TEST(Tidy, NormalsBecomeUnitAndBrokenOnesThatOfATriangle) {
  Mesh mesh = mesh_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 1, 2}});
  mesh.normals = {{0, 5, 0}, {0, 0, 0}, {kNan, 0, 0}};
  tidy(mesh);
  for (const Vec3& n : mesh.normals) EXPECT_EQ(n, Vec3(0, 1, 0));
}

TEST(Tidy, IsPartOfFinishingAScene) {
  Scene scene;
  scene.materials.emplace_back().base_color = {1.5f, -1, kNan};
  scene.materials[0].ior = 9;
  scene.meshes.push_back(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  scene.meshes.push_back(mesh_of({{0, 0, 0}}, {{0, 0, 0}}));
  Matrix flat, broken;
  flat.setScale(Vec3(1, 0, 1));
  broken[3][0] = kNan;
  scene.instances = {{0, Matrix()}, {0, flat}, {0, broken}, {1, Matrix()}};
  scene.spheres = {{{0, 0, 0}, 1, 0}, {{0, kNan, 0}, 1, 0}, {{0, 0, 0}, 0, 0}};
  scene.points = {{{0, 0, 0}, {-1, kNan, kInf}}};
  finish(scene, "f");
  EXPECT_EQ(scene.materials[0].base_color, Color(1, 0, 0));
  EXPECT_EQ(scene.materials[0].ior, 4);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.spheres.size(), 1u);
  EXPECT_EQ(scene.points[0].intensity.x, 0);
  EXPECT_EQ(scene.points[0].intensity.y, 0);
  EXPECT_TRUE(std::isfinite(scene.points[0].intensity.z));
  EXPECT_EQ(scene.cameras.size(), 1u);
  EXPECT_THAT(scene.warnings, testing::Contains(testing::HasSubstr("1 triangles without an area")));
  EXPECT_THAT(scene.warnings, testing::Contains(testing::HasSubstr("ior 9 is taken for 4")));
}

}  // namespace
}  // namespace tessera
