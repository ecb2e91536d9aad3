// SPDX-License-Identifier: Apache-2.0
// Kinds of materials under kinds of lights, where what the camera sees is known in closed form.
#include "tests/worker/render/known_radiance.h"

#include <functional>

#include "tests/worker/render/irradiance.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;
using Imath::V3d;
using tessera::testing::kPi;
using Kind = Material::Kind;

// Something above the origin that shines on it.
struct KnownLight {
  const char* name;
  double irradiance;  // of a surface there that faces up
  std::function<void(Scene&)> add;
};

int lamp(Scene& scene, float radiance) {
  return add_material(scene, emitter(Color(radiance, radiance, radiance)));
}

std::vector<KnownLight> lights_above() {
  const Quad rectangle{{-1, 2, -0.5f}, {2.5f, 0, 0}, {0, 0.5f, 2}}, square{{1, 1, 1}, {1, 0, 0}, {0, 0, 1}};
  const auto by_polygon = [](const Quad& q) {
    const V3d c(q.corner), u(q.edge_u), v(q.edge_v);
    return polygon({c, c + u, c + u + v, c + v}, {0, 1, 0}, {0, 0, 0});
  };
  return {
      {"a sky", 0.7 * kPi, [](Scene& s) { s.environment.radiance = Color(0.7f, 0.7f, 0.7f); }},
      {"a point", 2.0 / 3,
       [](Scene& s) {
         s.points.push_back({{1, 2, 2}, {9, 9, 9}});
       }},
      {"a spot", 1,
       [](Scene& s) {
         s.spots.push_back({{0, 2, 0}, {0, -1, 0}, {4, 4, 4}, 0.3f, 0.6f});
       }},
      {"a sun", 1.6,
       [](Scene& s) {
         s.suns.push_back({Vec3(0.6f, -0.8f, 0), {2, 2, 2}});
       }},
      {"a wide sun", 1.6,
       [](Scene& s) {
         s.suns.push_back({Vec3(0.6f, -0.8f, 0), {2, 2, 2}, 0.3f});
       }},
      {"a quad", by_polygon(rectangle),
       [=](Scene& s) {
         s.quads.push_back(rectangle);
         s.quads[0].material = lamp(s, 2);
       }},
      {"a mesh", by_polygon(square),
       [=](Scene& s) { add_mesh(s, grid(square.corner, square.edge_u, square.edge_v, 2, lamp(s, 2))); }},
      {"a disk", 2 * kPi * disk_factor(0.5, 1.5, 1),
       [](Scene& s) {
         s.disks.push_back({{1, 1.5f, 0}, {0, -1, 0}, 0.5f, lamp(s, 2)});
       }},
      {"a sphere", 3 * kPi * 0.25 / 6.25 * 0.8,
       [](Scene& s) {
         s.spheres.push_back({{1.5f, 2, 0}, 0.5f, lamp(s, 3)});
       }},
  };
}

struct Painting {
  std::string name;
  std::vector<Material> materials;  // the last is seen
  V3d reflectance;
};

std::vector<Painting> lambertian() {
  const Material dark{.base_color = Color(0.2f, 0.2f, 0.2f)}, light{.base_color = Color(0.8f, 0.4f, 0.8f)};
  return {
      {"diffuse", {{.base_color = Color(0.6f, 0.3f, 0.9f)}}, {0.6, 0.3, 0.9}},
      {"translucent",
       {{.kind = Kind::translucent,
         .base_color = Color(0.5f, 0.2f, 0.1f),
         .transmission_color = Color(0.4f, 0.5f, 0.6f)}},
       {0.5, 0.2, 0.1}},
      {"plastic of the index of air",
       {{.kind = Kind::plastic, .base_color = Color(0.6f, 0.3f, 0.9f), .roughness = 0, .ior = 1}},
       {0.6, 0.3, 0.9}},
      {"mix", {dark, light, {.kind = Kind::mix, .first = 0, .second = 1, .mix = 0.25f}}, {0.35, 0.25, 0.35}},
      {"mix with nothing",
       {{.kind = Kind::unlit}, light, {.kind = Kind::mix, .first = 0, .second = 1, .mix = 0.5f}},
       {0.4, 0.2, 0.4}},
  };
}

TEST(KnownRadiance, OfLambertianSurfacesIsTheirShareOfTheIrradiance) {
  for (const Painting& p : lambertian())
    for (const KnownLight& light : lights_above()) {
      Scene scene = origin_seen(p.materials);
      light.add(scene);
      V3d expected = p.reflectance * (light.irradiance / kPi);
      if (p.name == "translucent" && scene.environment.radiance.x > 0)  // it is lit from both sides
        expected += V3d(0.4, 0.5, 0.6) * 0.7;
      expect_radiance(scene, expected, (p.name + " under " + light.name).c_str());
    }
}

TEST(KnownRadiance, OfATranslucentSurfaceLitFromBehindIsWhatItTransmits) {
  for (const KnownLight& light : lights_above()) {
    Scene scene = origin_seen({{.kind = Kind::translucent,
                                .base_color = Color(0.5f, 0.2f, 0.1f),
                                .transmission_color = Color(0.4f, 0.5f, 0.6f)}},
                              -0.5f);
    light.add(scene);
    if (scene.environment.radiance.x > 0) continue;
    expect_radiance(scene, V3d(0.4, 0.5, 0.6) * (light.irradiance / kPi), light.name);
  }
}

// Saunderson 1942: what is below the boundary is seen through it twice, and between them light goes to and
// fro.
double undercoat(double color, double n, double in, double out) {
  const double within = 1 - (1 - mean_fresnel_of(n)) / (n * n);
  return color * in * out / (n * n * (1 - color * within));
}

TEST(KnownRadiance, OfPlasticUnderASunAndAPointIsThatOfItsBase) {
  const double out = 1 - fresnel_of(kViewCosine, 1.5);
  for (const KnownLight& light : {lights_above()[1], lights_above()[3]}) {
    Scene scene = origin_seen({{.kind = Kind::plastic, .base_color = Color(0.6f, 0.1f, 1), .roughness = 0}});
    light.add(scene);
    const double in = 1 - fresnel_of(scene.suns.empty() ? 2.0 / 3 : 0.8, 1.5);
    const auto f = [&](double color) { return undercoat(color, 1.5, in, out) * light.irradiance / kPi; };
    expect_radiance(scene, {f(0.6), f(0.1), f(1)}, light.name, 0, 64, 3e-4);
  }
}

std::vector<Painting> under_a_sky() {
  const Material gold{.kind = Kind::metal, .base_color = Color(1, 1, 1), .roughness = 0};
  const auto metal = [](double eta, double k) { return fresnel_of(kViewCosine, {eta, k}); };
  const Material tinted{
      .kind = Kind::glass, .base_color = Color(0.5f, 1, 0), .roughness = 0, .ior = 1.7f, .thin = true};
  const double r = pane(kViewCosine, 1.7, 1).reflects;
  const double gloss = fresnel_of(kViewCosine, 1.5), in = 1 - mean_fresnel_of(1.5);
  const auto plastic = [&](double color) { return gloss + undercoat(color, 1.5, in, 1 - gloss); };
  const Material mirror{.kind = Kind::mirror, .base_color = Color(0.9f, 0.5f, 0)};
  const auto schlick = [](double f0) { return f0 + (1 - f0) * std::pow(1 - kViewCosine, 5); };
  return {
      {"mirror", {mirror}, {0.9, 0.5, 0}},
      {"metal", {gold}, {metal(0.2, 3.9), metal(0.92, 2.45), metal(1.1, 2.14)}},
      {"thin glass", {tinted}, {r + (1 - r) * 0.5, 1, r}},
      {"plastic",
       {{.kind = Kind::plastic, .base_color = Color(0.5f, 1, 0), .roughness = 0}},
       {plastic(0.5), 1, gloss}},
      {"metal of glTF",
       {{.kind = Kind::metallic_roughness,
         .base_color = Color(0.9f, 0.5f, 0),
         .metallic = 1,
         .roughness = 0}},
       {schlick(0.9), schlick(0.5), schlick(0)}},
      {"mix of a mirror and paint",
       {mirror,
        {.base_color = Color(0.5f, 0.5f, 1)},
        {.kind = Kind::mix, .first = 0, .second = 1, .mix = 0.25f}},
       {0.8, 0.5, 0.25}},
  };
}

TEST(KnownRadiance, UnderASkyIsTheAlbedo) {
  for (const Painting& p : under_a_sky()) {
    Scene scene = origin_seen(p.materials);
    scene.environment.radiance = Color(3, 3, 3);
    expect_radiance(scene, p.reflectance * 3.0, p.name.c_str(), 0, 256, 1e-3);
  }
}

TEST(KnownRadiance, OfAnUnlitSurfaceIsItsColourWhateverTheLight) {
  for (const KnownLight& light : lights_above()) {
    Scene scene = origin_seen({{.kind = Kind::unlit, .base_color = Color(0.6f, 0.3f, 0.9f)}});
    light.add(scene);
    expect_radiance(scene, {0.6, 0.3, 0.9}, light.name, 8, 8, 1e-6);
  }
}

TEST(KnownRadiance, WhatAMirrorShowsIsThereInItsColour) {
  for (const Kind shown : {Kind::diffuse, Kind::unlit}) {
    Scene scene = origin_seen({{.kind = Kind::mirror, .base_color = Color(0.5f, 0.25f, 1)}});
    const Material lit{.kind = shown, .base_color = Color(0, 0, 0), .emission = Color(2, 3, 4)},
        flat{.kind = shown, .base_color = Color(0.5f, 0.7f, 1)};
    add_mesh(scene, level(2, add_material(scene, shown == Kind::unlit ? flat : lit), false));
    const V3d seen = shown == Kind::unlit ? V3d(0.25, 0.175, 1) : V3d(1, 0.75, 4);
    expect_radiance(scene, seen, "in one mirror", 0, 8, 1e-6);
  }
}

// It is light and receives light: from outside none of its own, from inside all of it, again and again.
TEST(KnownRadiance, OfASphereThatGlowsAndScattersIsKnownOnBothSides) {
  for (const Vec3& center : {Vec3(0, 0, 0), Vec3(300, -20, 7)})
    for (const float radius : {0.05f, 1.0f, 40.0f}) {
      Scene scene;
      add_material(scene, {.base_color = Color(0.5f, 0.5f, 0.5f), .emission = Color(1, 2, 3)});
      scene.spheres.push_back({center, radius, 0});
      scene.cameras = {camera_at(center + Vec3(0, 0, 3) * radius, center, 0.5f)};
      expect_radiance(scene, {1, 2, 3}, "from outside", 8, 16, 1e-6);
      scene.cameras = {camera_at(center + Vec3(0.2f, 0.1f, 0.3f) * radius, center - Vec3(0, 0, radius), 1)};
      expect_radiance(scene, {2, 4, 6}, "from inside", 40, 256);
    }
}

// Sphere of clear glass of index 1 and of absorption s per metre, seen by parallel rays: the mean over its
// disc of exp(-s chord).
TEST(KnownRadiance, OfASphereThatAbsorbsIsBeersLawOverItsChords) {
  Scene scene;
  add_material(scene, {.kind = Kind::glass,
                       .base_color = Color(1, 1, 1),
                       .roughness = 0,
                       .ior = 1,
                       .attenuation_color = Color(0.5f, 0.1f, 0.9f),
                       .attenuation_distance = 0.7f});
  scene.spheres.push_back({{0, 0, 0}, 1, 0});
  scene.environment.radiance = Color(1, 1, 1);
  scene.cameras = {camera_at({0, 0, 5}, {0, 0, 0}, 1)};
  scene.cameras[0].projection = Camera::Projection::orthographic;
  scene.cameras[0].height = 2;
  const Measured m = measure(scene, 64, 64, 1);
  for (int c = 0; c < 3; ++c) {
    const double s = -std::log(double(scene.materials[0].attenuation_color[c])) / 0.7;
    const double disc = 2 * (1 / (4 * s * s) - std::exp(-2 * s) * (1 / (2 * s) + 1 / (4 * s * s)));
    // The pixels differ by what they show, not by chance: strata leave an error of about 1e-4.
    EXPECT_NEAR(m.mean[c], 1 - kPi / 4 * (1 - disc), 5e-4) << c;
  }
}

const Color kSky(0.5f, 0.5f, 0.5f), kWall(3, 1, 2);

TEST(KnownRadiance, ThroughAThinPaneIsWhatItLetsThroughAndReflects) {
  for (const float ior : {1.0f, 1.5f, 2.4f}) {
    Scene scene = origin_seen({{.kind = Kind::glass,
                                .base_color = Color(1, 0.5f, 0.25f),
                                .roughness = 0,
                                .ior = ior,
                                .thin = true}});
    add_mesh(scene, level(-1, add_material(scene, emitter(kWall))));
    scene.environment.radiance = kSky;
    const Pane p = pane(kViewCosine, ior, 1);
    expect_radiance(scene, V3d(kSky) * p.reflects + V3d(kWall) * V3d(1, 0.5, 0.25) * (1 - p.reflects), "pane",
                    0, 256);
  }
}

TEST(KnownRadiance, ThroughASlabIsTheSeriesOfItsTwoSidesWithBeersLaw) {
  for (const float ior : {1.0f, 1.5f, 2.4f})
    for (const float metres : {0.0f, 0.1f}) {
      Scene scene = origin_seen({{.kind = Kind::glass,
                                  .base_color = Color(1, 1, 1),
                                  .roughness = 0,
                                  .ior = ior,
                                  .attenuation_color = Color(0.5f, 0.2f, 0.9f),
                                  .attenuation_distance = metres}});
      add_mesh(scene, level(-0.1f, 0, false));
      add_mesh(scene, level(-1, add_material(scene, emitter(kWall))));
      scene.environment.radiance = kSky;
      const double within = std::sqrt(1 - 0.36 / (ior * ior));
      V3d expected;
      for (int c = 0; c < 3; ++c) {
        const double a =
            metres > 0 ? std::pow(double(scene.materials[0].attenuation_color[c]), 1 / within) : 1;
        const Pane p = pane(kViewCosine, ior, a);
        expected[c] = p.reflects * kSky[c] + p.transmits * kWall[c];
      }
      expect_radiance(scene, expected, "slab", 64, 256);
    }
}

// The way to the light and the way to the eye both lie in what absorbs.
TEST(KnownRadiance, InsideWhatAbsorbsLightLosesOnItsWayFromTheLightToo) {
  Scene scene = origin_seen({{.kind = Kind::glass,
                              .base_color = Color(1, 1, 1),
                              .roughness = 0,
                              .ior = 1,
                              .attenuation_color = Color(0.5f, 0.2f, 0.9f),
                              .attenuation_distance = 1},
                             {.base_color = Color(0.5f, 0.5f, 0.5f)}},
                            2.5f);
  add_mesh(scene, level(1, 0));
  scene.points.push_back({{0, 0.5f, 0}, {1, 1, 1}});
  V3d expected;
  for (int c = 0; c < 3; ++c)
    expected[c] = 0.5 / kPi * 4 * std::pow(double(scene.materials[0].attenuation_color[c]), 0.5 + 1 / 0.8);
  expect_radiance(scene, expected, "point in coloured air", 1);
}

}  // namespace
}  // namespace tessera::tracer
