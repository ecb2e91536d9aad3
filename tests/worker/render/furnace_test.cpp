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

struct Kindred {
  const char* name;
  std::vector<Material> materials;  // the last is looked at
  bool lossless_if_smooth = false, lossless = false;
};

// White materials of every kind.
std::vector<Kindred> white_materials(float roughness) {
  using enum Material::Kind;
  const Color white(1, 1, 1), half(0.5f, 0.5f, 0.5f);
  const auto of = [&](Material::Kind kind) {
    return Material{.kind = kind, .base_color = white, .roughness = roughness};
  };
  const auto gltf = [&](auto&& change) {
    Material m = of(metallic_roughness);
    change(m);
    return std::vector<Material>{m};
  };
  Material sheet = of(glass), cloth = of(translucent), perfect = of(metal), lobe = of(metal);
  sheet.thin = true;
  cloth.base_color = half, cloth.transmission_color = half;
  perfect.eta = lobe.eta = Color(0, 0, 0), perfect.k = lobe.k = white;  // reflects all, at every angle
  lobe.exponent = roughness > 0 ? 2 / (roughness * roughness) : 1e6f;
  const Material blend{.kind = mix, .first = 0, .second = 1, .mix = 0.3f};
  return {
      {"diffuse", {of(diffuse)}, true, true},
      {"mirror", {of(mirror)}, true, true},
      {"translucent", {cloth}, true, true},
      {"glass", {of(glass)}, true},
      {"thin glass", {sheet}, true},
      {"metal", {perfect}, true},
      {"copper", {of(metal)}},
      {"cosine lobe", {lobe}},
      {"plastic", {of(plastic)}, true},
      {"mix of plastic and metal", {of(plastic), perfect, blend}, true},
      {"mix of glass and paint", {of(glass), of(diffuse), blend}, true},
      {"glTF metal", gltf([](Material& m) { m.metallic = 1; })},
      {"glTF dielectric", gltf([](Material&) {})},
      {"glTF half metal", gltf([](Material& m) { m.metallic = 0.5f; })},
      {"glTF transmission", gltf([](Material& m) { m.transmission = 1; }), true},
      {"glTF thin transmission", gltf([](Material& m) { m.transmission = 1, m.thin = true; }), true},
      {"glTF half transmission", gltf([](Material& m) { m.transmission = 0.5f; })},
      {"glTF coat", gltf([&](Material& m) { m.clearcoat = 1, m.clearcoat_roughness = roughness; })},
      {"glTF sheen", gltf([&](Material& m) { m.sheen_color = white, m.sheen_roughness = roughness; })},
      {"glTF coat and sheen",
       gltf([&](Material& m) { m.clearcoat = 0.5f, m.sheen_color = half, m.sheen_roughness = roughness; })},
  };
}

// A sphere in a sky of radiance 1, of which the rest of the frame shows: no brighter, and where nothing is
// lost not there.
TEST(Furnace, NoKindOfMaterialAddsLightAtAnyRoughness) {
  for (const float roughness : {0.0f, 0.1f, 0.3f, 0.6f, 1.0f})
    for (const Kindred& k : white_materials(roughness)) {
      Scene scene;
      scene.materials = k.materials;
      scene.spheres.push_back({{0, 0, 0}, 1, static_cast<int>(k.materials.size()) - 1});
      scene.environment.radiance = Color(1, 1, 1);
      scene.cameras = {camera_at({0, 0, 5}, {0, 0, 0}, 1)};
      scene.cameras[0].projection = Camera::Projection::orthographic;
      scene.cameras[0].height = 2;
      const Measured m = measure(scene, 16, 32, 100);
      const bool whole = k.lossless || (k.lossless_if_smooth && roughness == 0);
      for (int c = 0; c < 3; ++c) {
        EXPECT_LE(m.mean[c], 1 + 4 * m.error[c] + 1e-4) << k.name << " of roughness " << roughness;
        if (whole) {
          EXPECT_GE(m.mean[c], 1 - 4 * m.error[c] - 1e-4) << k.name << " of roughness " << roughness;
        }
      }
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
