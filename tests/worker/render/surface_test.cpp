// SPDX-License-Identifier: Apache-2.0
// Hits, instances, textures and the camera's rays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/scenes.h"
#include "worker/render/camera.h"
#include "worker/render/render_scene.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;
using tessera::testing::kPi;

// A tetrahedron-like tent, front outwards (up).
Mesh tent(int material) {
  Mesh m{.positions = {{-1, 0, 1}, {1, 0, 1}, {0, 0, -1}, {0.2f, 0.8f, 0}}, .material = material};
  m.triangles = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return m;
}

TEST(Geometry, TheFrontStaysTheFrontInAMirroredInstance) {
  Scene scene;
  add_material(scene, {});
  add_mesh(scene, tent(0));
  scene.instances.push_back({0, Matrix().scale(Vec3(-2, 1, 0.5f)) * Matrix().translate(Vec3(5, 0, 0))});
  const Geometry geometry(scene);
  for (std::uint32_t piece = 0; piece < 2; ++piece)
    for (std::uint32_t t = 0; t < 3; ++t) {
      const Triangle triangle = geometry.triangle(piece, t);
      EXPECT_GT(triangle.normal.y, 0);
      EXPECT_NEAR(dot(unit(triangle.normal), unit(triangle.p[1] - triangle.p[0])), 0, 1e-6f);
      EXPECT_NEAR(dot(unit(triangle.normal), unit(triangle.p[2] - triangle.p[0])), 0, 1e-6f);
    }
}

// What keeps its corners is found by them, the same mesh in an instance that leaves it in its place is not.
TEST(Geometry, ASurfaceIsTheSameByTheCornersThatAreKept) {
  Scene scene;
  add_material(scene, {});
  Mesh mesh = tent(0);
  for (const Vec3& n : {Vec3(-1, 1, 1), Vec3(1, 1, 1), Vec3(0, 1, -1), Vec3(0, 3, 0)})
    mesh.normals.push_back(n);
  for (const Vec3& p : mesh.positions) {
    mesh.uvs.emplace_back(p.x, p.z);
    mesh.uvs2.emplace_back(p.z, 3 * p.x);
  }
  add_mesh(scene, mesh);
  scene.instances.push_back({0, Matrix().translate(Vec3(0, 1e-30f, 0))});
  const Geometry geometry(scene);
  EXPECT_EQ(geometry.corners({1, 0, 0, 0}), nullptr);
  for (std::uint32_t t = 0; t < 3; ++t) {
    const Hit hit{0, t, 0.3f, 0.45f};
    const Corners* corners = geometry.corners(hit);
    ASSERT_NE(corners, nullptr);
    EXPECT_EQ(*corners, geometry.triangle(0, t).p);
    const Surface expected = geometry.surface({1, t, 0.3f, 0.45f}, {0, 9, 0}, {0, -1, 0}, 8.5f, 0.25f);
    Surface s = geometry.surface({1, (t + 1) % 3, 0.1f, 0.1f}, {0, 9, 0}, {0, -1, 0}, 8.5f);
    geometry.surface_at(hit, expected.position, expected.ng, 0.25f, s);
    EXPECT_LT(length(s.ns - expected.ns), 1e-6f);
    EXPECT_EQ(s.uv, expected.uv);
    EXPECT_EQ(s.uv2, expected.uv2);
    EXPECT_EQ(s.material, expected.material);
    EXPECT_EQ(s.time, expected.time);
    EXPECT_EQ(s.light, -1);
  }
}

TEST(Geometry, WhatEmitsIsNotFoundByItsCorners) {
  Scene scene;
  add_material(scene, {.emission = Color(1, 1, 1)});
  add_mesh(scene, tent(0));
  Geometry geometry(scene);
  const Materials materials(scene);
  const Lights lights(scene, geometry, materials, 1);
  EXPECT_EQ(geometry.corners({0, 0, 0, 0}), nullptr);
}

TEST(Geometry, AnOffsetOriginIsBeyondTheSurfaceOnTheSideOfTheNormal) {
  Random random(4);
  for (int i = 0; i < 10000; ++i) {
    const float scale = std::exp(20 * random.number() - 10);
    const Vec2 u = random.pair(), v = random.pair();
    const Vec3 normal = from_square(u.x, u.y);
    const Vec3 p = from_square(v.x, v.y) * scale;
    const Vec3 moved = offset_origin(p, normal) - p;
    EXPECT_GT(dot(moved, normal), 0);
    EXPECT_LT(length(moved), 1e-4f * (1 + scale));
  }
}

// The same tents, shared as instances or each a mesh of its own.
TEST(Bvh, InstancesLookLikeTheMeshesTheyStandFor) {
  const Matrix placed = Matrix().rotate(Vec3(0.3f, 0.4f, 0)) * Matrix().translate(Vec3(2, 0, -1));
  const auto scene_of = [&](bool shared) {
    Scene scene;
    add_floor(scene, Color(0.5f, 0.5f, 0.5f));
    const int red = add_material(scene, {.base_color = Color(0.8f, 0.2f, 0.2f)});
    add_mesh(scene, tent(red));
    if (shared)
      scene.instances.push_back({1, placed});
    else
      add_mesh(scene, tent(red), placed);
    scene.suns.push_back({Vec3(0.6f, -0.8f, 0), {2, 2, 2}, 0.01f});
    scene.environment.radiance = Color(0.3f, 0.4f, 0.5f);
    scene.cameras = {camera_at({1, 3, 5}, {1, 0, 0}, 0.8f)};
    return scene;
  };
  for (const Aov aov : {Aov::color, Aov::normal, Aov::position, Aov::albedo}) {
    const Measured a = measure(scene_of(true), 32, 16, 2, aov), b = measure(scene_of(false), 32, 16, 2, aov);
    // The same random numbers and, up to rounding, the same paths.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a.mean[c], b.mean[c], 2e-3 * std::abs(b.mean[c]) + 1e-4);
  }
}

TEST(Bvh, AnEmptySceneIsAllSky) {
  Scene scene;
  scene.environment.radiance = Color(0.25f, 0.5f, 1);
  scene.cameras = {camera_at({0, 0, 0}, {0, 0, -1}, 1)};
  const Measured m = measure(scene, 8, 8, 2);
  EXPECT_FLOAT_EQ(float(m.mean[0]), 0.25f);
  EXPECT_FLOAT_EQ(float(m.mean[2]), 1);
}

TEST(Bvh, DegenerateTrianglesAreHarmless) {
  Scene scene;
  add_floor(scene, Color(0.5f, 0.5f, 0.5f));
  const int lamp = add_material(scene, {.emission = Color(1, 1, 1)});
  Mesh flat{.positions = {{0, 1, 0}, {0, 1, 0}, {1, 1, 0}, {1, 1, 1}}, .material = lamp};
  flat.triangles = {{0, 1, 2}, {2, 2, 2}, {0, 2, 3}};
  add_mesh(scene, flat);
  add_mesh(scene, Mesh{.material = lamp});
  scene.cameras = {camera_at({0, 2, 3}, {0, 0, 0}, 0.8f)};
  const RenderSettings settings{.size = {16, 16}};
  EXPECT_EQ(dropped(render(*prepared(scene), settings, 0, {0, 0, 16, 16}, {0, 16})), 0u);
}

TEST(Camera, FieldsOfViewReachTheEdgesOfTheFrame) {
  Camera camera;
  camera.vertical_fov = kPi / 2;
  const CameraRays vertical({}, camera, {200, 100}, 0, 0);
  EXPECT_LT(length(vertical.ray(100, 0, {}, 0).direction - unit(Vec3(0, 1, -1))), 1e-6f);
  EXPECT_LT(length(vertical.ray(200, 50, {}, 0).direction - unit(Vec3(2, 0, -1))), 1e-6f);
  camera.horizontal_fov = kPi / 2;
  const CameraRays horizontal({}, camera, {200, 100}, 0, 0);
  EXPECT_LT(length(horizontal.ray(0, 50, {}, 0).direction - unit(Vec3(-1, 0, -1))), 1e-6f);
}

}  // namespace
}  // namespace tessera::tracer
