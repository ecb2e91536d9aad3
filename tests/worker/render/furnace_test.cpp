// SPDX-License-Identifier: Apache-2.0
// Energy: what neither emits nor absorbs is invisible in uniform light.
#include <gtest/gtest.h>

#include "tests/worker/render/scenes.h"
#include "worker/render/bsdf/bsdf.h"

namespace tessera {
namespace {

using namespace testing;

// Spheres and a corner of two walls, of one material, in a sky of radiance 1.
Scene furnace(const Material& material) {
  Scene scene;
  add_material(scene, material);
  scene.environment.radiance = Color(1, 1, 1);
  scene.spheres.push_back({{0, 0, 0}, 1, 0});
  scene.spheres.push_back({{1.4f, 0.8f, 0.2f}, 0.7f, 0});
  scene.spheres.push_back({{-1.2f, -0.3f, 1}, 0.5f, 0});
  add_mesh(scene, grid({-3, -1.5f, 2}, {6, 0, 0}, {0, 0, -5}, 2, 0));
  add_mesh(scene, grid({-3, -1.5f, -3}, {6, 0, 0}, {0, 4, 0}, 2, 0));
  scene.cameras = {camera_at({0, 1, 6}, {0, 0, 0}, 0.8f)};
  return scene;
}

constexpr int kForever = 1000;

TEST(Furnace, WhiteDiffuseSurfacesAreInvisible) {
  const Measured m = measure(furnace({.base_color = Color(1, 1, 1)}), 24, 16, kForever);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.mean[c], 1, 5 * m.error[c] + 1e-5);
}

TEST(Furnace, PerfectMirrorsAreInvisible) {
  const Measured m =
      measure(furnace({.kind = Material::Kind::mirror, .base_color = Color(1, 1, 1)}), 24, 16, kForever);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.mean[c], 1, 5 * m.error[c] + 1e-5);
}

TEST(Furnace, ClearGlassIsInvisible) {
  Scene scene =
      furnace({.kind = Material::Kind::glass, .base_color = Color(1, 1, 1), .roughness = 0, .ior = 1.5f});
  // Panes have no inside; only bodies.
  scene.meshes.clear();
  scene.instances.clear();
  const Measured m = measure(scene, 24, 64, kForever);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.mean[c], 1, 5 * m.error[c] + 1e-5);
}

TEST(Furnace, GlossyAndMetalSurfacesAddNoLight) {
  for (const float roughness : {0.0f, 0.3f, 0.6f, 1.0f}) {
    for (const float metallic : {0.0f, 0.5f, 1.0f}) {
      const Measured m = measure(furnace({.kind = Material::Kind::metallic_roughness,
                                          .base_color = Color(1, 1, 1),
                                          .metallic = metallic,
                                          .roughness = roughness}),
                                 24, 16, 16);
      for (int c = 0; c < 3; ++c) EXPECT_LE(m.mean[c], 1 + 5 * m.error[c]) << roughness << " " << metallic;
    }
    const Measured m = measure(
        furnace({.kind = Material::Kind::metal, .base_color = Color(1, 1, 1), .roughness = roughness}), 24,
        16, 16);
    for (int c = 0; c < 3; ++c) EXPECT_LE(m.mean[c], 1 + 5 * m.error[c]) << roughness;
  }
}

// A closed room whose walls all emit e and reflect r: light that was reflected n times is e r^n, everywhere.
Scene closed_room(float emission, float reflectance) {
  Scene scene;
  add_material(scene, {.base_color = Color(reflectance, reflectance, reflectance),
                       .emission = Color(emission, emission, emission),
                       .double_sided = false});
  const float d = 2;
  add_mesh(scene, grid({-1, -1, 1}, {d, 0, 0}, {0, 0, -d}, 2, 0));
  add_mesh(scene, grid({-1, 1, -1}, {d, 0, 0}, {0, 0, d}, 2, 0));
  add_mesh(scene, grid({-1, -1, -1}, {d, 0, 0}, {0, d, 0}, 2, 0));
  add_mesh(scene, grid({1, -1, 1}, {-d, 0, 0}, {0, d, 0}, 2, 0));
  add_mesh(scene, grid({-1, -1, 1}, {0, 0, -d}, {0, d, 0}, 2, 0));
  add_mesh(scene, grid({1, -1, -1}, {0, 0, d}, {0, d, 0}, 2, 0));
  scene.cameras = {camera_at({0.2f, 0.1f, 0.5f}, {-0.3f, -0.2f, -1}, 1.2f)};
  return scene;
}

TEST(Furnace, AClosedRoomHoldsTheGeometricSeriesOfItsBounces) {
  for (const int bounces : {0, 1, 2, 5}) {
    const Measured m = measure(closed_room(1, 0.5f), 32, 256, bounces);
    double expected = 0;
    for (int n = 0; n <= bounces + 1; ++n) expected += std::pow(0.5, n);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(m.mean[c], expected, 5 * m.error[c] + 1e-5) << bounces << " bounces";
  }
}

TEST(Furnace, InsideAnEmittingSphereAllIsInUniformLight) {
  Scene scene;
  const int shell = add_material(scene, {.base_color = Color(0, 0, 0), .emission = Color(1, 1, 1)});
  const int white = add_material(scene, {.base_color = Color(1, 1, 1)});
  scene.spheres.push_back({{0, 0, 0}, 10, shell});
  scene.spheres.push_back({{0, 0, 0}, 1, white});
  scene.cameras = {camera_at({0, 0, 4}, {0, 0, 0}, 0.6f)};
  const Measured m = measure(scene, 24, 256, 3);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.mean[c], 1, 5 * m.error[c] + 1e-4);
}

}  // namespace
}  // namespace tessera
