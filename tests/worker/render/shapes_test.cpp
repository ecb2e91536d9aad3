// SPDX-License-Identifier: Apache-2.0
// Spheres, quads and disks as what rays hit; which rays see what; holes.
#include <gtest/gtest.h>

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/one_ray.h"
#include "tests/worker/render/scenes.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;

Scene with_material() {
  Scene scene;
  add_material(scene, {});
  return scene;
}

void expect_near(const Vec3& a, const Vec3& b, float slack = 1e-5f) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], slack);
}

TEST(Shapes, AQuadIsHitWithinItsEdgesWithCoordinatesAlongThem) {
  Scene scene = with_material();
  const Quad quad{.corner = {1, 2, 3}, .edge_u = {2, 0.5f, 0}, .edge_v = {0.3f, 1, 1}};
  scene.quads.push_back(quad);
  const auto ready = prepared(scene);
  const Vec3 normal = unit(cross(quad.edge_u, quad.edge_v));
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    const float u = 1.6f * random.number() - 0.3f, v = 1.6f * random.number() - 0.3f;
    if (std::min({std::abs(u), std::abs(v), std::abs(u - 1), std::abs(v - 1)}) < 1e-4f) continue;
    const bool within = u > 0 && u < 1 && v > 0 && v < 1;
    const Vec3 at = quad.corner + quad.edge_u * u + quad.edge_v * v;
    const Vec3 from = at + normal * 3.0f + quad.edge_u;
    const auto seen = look(*ready, from, unit(at - from));
    ASSERT_EQ(seen.has_value(), within) << u << " " << v;
    if (!within) continue;
    expect_near(seen->surface.position, at);
    expect_near(seen->surface.ng, normal);
    EXPECT_NEAR(seen->surface.uv.x, u, 1e-5f);
    EXPECT_NEAR(seen->surface.uv.y, v, 1e-5f);
  }
  EXPECT_TRUE(look(*ready, quad.corner + (quad.edge_u + quad.edge_v) * 0.4f - normal, normal))
      << "from behind";
}

TEST(Shapes, ADiskIsHitWithinItsRadius) {
  Scene scene = with_material();
  const Disk disk{.center = {1, -2, 0.5f}, .normal = unit(Vec3(1, 2, -1)), .radius = 0.7f};
  scene.disks.push_back(disk);
  const auto ready = prepared(scene);
  const Frame frame(disk.normal);
  Random random(6);
  for (int i = 0; i < 300; ++i) {
    const float x = 2 * random.number() - 1, y = 2 * random.number() - 1, r = std::hypot(x, y);
    if (std::abs(r - 0.7f) < 1e-4f) continue;
    const Vec3 at = disk.center + frame.x * x + frame.y * y;
    const Vec3 from = at + disk.normal * (i % 2 ? 2.0f : -2.0f) + frame.x;
    const auto seen = look(*ready, from, unit(at - from));
    ASSERT_EQ(seen.has_value(), r < 0.7f) << x << " " << y;
    if (r > 0.7f) continue;
    expect_near(seen->surface.position, at);
    expect_near(seen->surface.ng, disk.normal);
    EXPECT_NEAR(seen->surface.uv.x, 0.5f + x / 1.4f, 1e-5f);
    EXPECT_NEAR(seen->surface.uv.y, 0.5f + y / 1.4f, 1e-5f);
  }
}

// One of each kind along +X, each of its own object.
Scene row(const std::vector<Object>& objects) {
  Scene scene = with_material();
  scene.objects = objects;
  add_mesh(scene, grid({-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}, 1, 0));
  scene.instances[0].object = 0;
  for (int i = 0; i < 2; ++i)  // of a mesh that is there twice
    scene.instances.push_back({0, Matrix().translate(Vec3(2.0f + 2.0f * float(i), 0, 0)), 1 + i});
  scene.meshes.push_back(scene.meshes[0]);
  scene.instances[0].mesh = 1;
  scene.spheres.push_back({.center = {6, 0, 0}, .radius = 0.5f, .object = 3});
  scene.spheres.push_back({.center = {8, 0, 0}, .radius = 0.5f, .object = 4});
  scene.quads.push_back({.corner = {9.5f, -0.5f, 0}, .object = 5});
  scene.quads.push_back({.corner = {11.5f, -0.5f, 0}, .object = 6});
  scene.disks.push_back({.center = {14, 0, 0}, .normal = {0, 0, 1}, .radius = 0.5f, .object = 7});
  scene.disks.push_back({.center = {16, 0, 0}, .normal = {0, 0, 1}, .radius = 0.5f, .object = 8});
  return scene;
}

TEST(Visibility, EachKindOfRaySeesTheObjectsThatItMayAndKnowsWhichTheyAre) {
  for (int turn = 0; turn < 8; ++turn) {
    std::vector<Object> objects(9);
    for (int i = 0; i < 9; ++i) {
      const int bits = (i * 3 + turn) % 8;
      objects[std::size_t(i)] = {
          .camera = (bits & 1) != 0, .scattered = (bits & 2) != 0, .shadow = (bits & 4) != 0};
    }
    const auto ready = prepared(row(objects));
    for (int i = 0; i < 9; ++i) {
      const Vec3 from(2.0f * float(i) + 0.1f, 0.1f, 3), way(0, 0, -1);
      const Object& o = objects[std::size_t(i)];
      const auto by_camera = look(*ready, from, way, {.kind = RayKind::camera});
      const auto by_scattered = look(*ready, from, way, {.kind = RayKind::scattered});
      EXPECT_EQ(by_camera.has_value(), o.camera) << i << " turn " << turn;
      EXPECT_EQ(by_scattered.has_value(), o.scattered) << i << " turn " << turn;
      EXPECT_EQ(blocked(*ready, from, way, kEndless), o.shadow) << i << " turn " << turn;
      for (const auto& seen : {by_camera, by_scattered}) {
        if (seen) {
          EXPECT_EQ(ready->geometry().object(seen->hit), i);
        }
      }
    }
  }
}

TEST(Visibility, OfTwoObjectsInLineTheNearerHidesOnlyFromRaysThatSeeIt) {
  Scene scene = with_material();
  scene.objects = {{.camera = false}, {}};
  scene.disks.push_back({.center = {0, 0, 1}, .normal = {0, 0, 1}, .object = 0});
  scene.disks.push_back({.center = {0, 0, 0}, .normal = {0, 0, 1}, .object = 1});
  const auto ready = prepared(scene);
  const auto object = [&](RayKind kind) {
    return ready->geometry().object(look(*ready, {0, 0, 3}, {0, 0, -1}, {.kind = kind})->hit);
  };
  EXPECT_EQ(object(RayKind::camera), 1);
  EXPECT_EQ(object(RayKind::scattered), 0);
}

TEST(Holes, AreWhereTheTextureOfAShapeSaysAndKnowTheSeedOfTheRay) {
  Scene scene = with_material();
  scene.spheres.push_back({.center = {0, 0, 0}, .radius = 1});
  scene.quads.push_back({.corner = {4, -1, 0}, .edge_u = {2, 0, 0}, .edge_v = {0, 2, 0}});
  scene.disks.push_back({.center = {9, 0, 0}, .normal = {0, 0, 1}, .radius = 1});
  const Geometry geometry(scene);
  // Solid on the half of small u, and only for odd seeds.
  const auto everywhere = [](int) { return true; };
  const Bvh bvh(
      geometry, std::make_shared<const BvhCore>(geometry, everywhere),
      [&](const Hit& hit, std::uint32_t seed) { return geometry.uv(hit).x < 0.5f && seed % 2 == 1; });
  for (const std::uint32_t seed : {7u, 8u}) {
    const RayTraits traits{.seed = seed};
    const auto there = [&](const Vec3& from) {
      return look(geometry, bvh, from, {0, 0, -1}, traits).has_value();
    };
    EXPECT_EQ(there({4.5f, 0, 3}), seed == 7);
    EXPECT_FALSE(there({5.5f, 0, 3}));
    EXPECT_EQ(there({-0.5f, 0, 3}), seed == 7);  // sphere: u < 1/2 at -X
    EXPECT_FALSE(there({0.5f, 0, 3}));
    const Vec3 along = Frame(Vec3(0, 0, 1)).x;
    EXPECT_EQ(there(Vec3(9, 0, 3) - along * 0.4f), seed == 7);
    EXPECT_FALSE(there(Vec3(9, 0, 3) + along * 0.4f));
  }
}

}  // namespace
}  // namespace tessera::tracer
