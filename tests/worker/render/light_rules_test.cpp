// SPDX-License-Identifier: Apache-2.0
// What alpha, visibility, factors of lights and regularisation do to a whole render: exact where they promise
// a factor or no change.
#include <functional>

#include "tests/worker/render/known_radiance.h"

namespace tessera {
namespace {

using namespace testing;
using Kind = Material::Kind;
using Imath::V3d;

const Color kBlack(0, 0, 0), kHalf(0.5f, 0.5f, 0.5f), kWhite(1, 1, 1);

Image pixels(const Scene& scene, const RenderSettings& like = {}, int samples = 16) {
  RenderSettings settings = like;
  settings.size = {8, 8};
  return developed(render(*prepared(scene), settings, 0, {0, 0, 8, 8}, {0, samples}).sums,
                   FilmLayout(settings.aovs), channels_of(Aov::color), Part::all);
}

bool is_lit(const Image& image) {
  for (const float v : image.data())
    if (v > 0) return true;
  return false;
}

TEST(Blend, LetsThroughTheShareThatIsNotThere) {
  Scene scene = origin_seen({{.base_color = kBlack, .alpha = Material::Alpha::blend, .base_alpha = 0.25f}});
  add_mesh(scene, level(-1, add_material(scene, emitter({4, 2, 1}))));
  expect_radiance(scene, {3, 1.5, 0.75}, "an emitter behind", 0, 256);
}

TEST(Blend, OfTwoSheetsIsThatOfEachOnItsOwn) {
  Scene scene = origin_seen({{.base_color = kBlack, .alpha = Material::Alpha::blend, .base_alpha = 0.25f}});
  add_mesh(scene, level(-0.5f, 0));
  add_mesh(scene, level(-1, add_material(scene, emitter({4, 2, 1}))));
  expect_radiance(scene, {2.25, 1.125, 0.5625}, "an emitter behind two", 0, 256);
}

TEST(Blend, CastsTheShadowOfItsShare) {
  Scene scene = origin_seen({{.base_color = kHalf}});
  const Material veil{.base_color = kBlack, .alpha = Material::Alpha::blend, .base_alpha = 0.25f};
  add_mesh(scene, level(2, add_material(scene, veil)));
  scene.suns.push_back({{0, -1, 0}, {1, 1, 1}});
  const double lit = 0.75 * 0.5 / kPi;
  expect_radiance(scene, {lit, lit, lit}, "a sun behind", 0, 256);
}

TEST(Blend, FollowsTheAlphaOfItsVertices) {
  Scene scene;
  add_material(scene, {.base_color = kBlack, .alpha = Material::Alpha::blend});
  Mesh sheet = grid({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 1, 0);
  sheet.colors = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 0}, {1, 1, 1, 1}};  // there at the right
  add_mesh(scene, sheet);
  add_mesh(scene, grid({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, 1, add_material(scene, emitter({4, 2, 1}))));
  scene.cameras = {camera_at({0, 0, 5}, {0, 0, 0}, 1)};
  scene.cameras[0].projection = Camera::Projection::orthographic;
  scene.cameras[0].height = 2;
  constexpr int kSamples = 512;
  const Image seen = pixels(scene, {.max_bounces = 0}, kSamples);
  for (int x = 0; x < 8; ++x) {
    double column = 0;
    for (int y = 0; y < 8; ++y) column += seen.at(0, x, y) / 8;
    const double there = (x + 0.5) / 8;
    EXPECT_NEAR(column, 4 * (1 - there), 4 * 4 * std::sqrt(there * (1 - there) / (8 * kSamples))) << x;
  }
}

// A light of each kind that is in view at the origin of a level of `receiver`, also in a mirror.
struct NamedLight {
  const char* name;
  std::function<void(Scene&, const LightTraits&)> add;
  bool in_mirrors = true;
};
std::vector<NamedLight> named_lights() {
  const auto shape = [](Scene& s, const LightTraits& traits) {
    s.objects = {{.light = traits}};
    return add_material(s, emitter({2, 2, 2}));
  };
  const auto sky = [](Scene& s, const LightTraits& t) { s.environment = {.radiance = kWhite, .light = t}; };
  const auto picture = [](Scene& s, const LightTraits& t) {
    s.pictures.push_back({"sky", 2, 1, 1, {0.5f, 1}});
    s.environment = {.radiance = kWhite, .picture = 0, .light = t};
  };
  return {
      {"point",
       [](Scene& s, const auto& t) {
         s.points.push_back({{-1, 2, 0}, kWhite, t});
       },
       false},
      {"spot",
       [](Scene& s, const auto& t) {
         s.spots.push_back({{-0.5f, 2, 0}, {0, -1, 0}, kWhite, 0.5f, 1, t});
       },
       false},
      {"sun",
       [](Scene& s, const auto& t) {
         s.suns.push_back({{0, -1, 0}, kWhite, 0, true, t});
       },
       false},
      {"wide sun",
       [](Scene& s, const auto& t) {
         s.suns.push_back({Vec3(0.6f, -0.8f, 0), kWhite, 0.3f, true, t});
       }},
      {"sky", sky},
      {"picture", picture},
      {"mesh",
       [=](Scene& s, const auto& t) {
         add_mesh(s, grid({-6, 2, -6}, {9, 0, 0}, {0, 0, 9}, 2, shape(s, t)));
         s.instances.back().object = 0;
       }},
      {"quad",
       [=](Scene& s, const auto& t) {
         s.quads.push_back({{-6, 2, -6}, {9, 0, 0}, {0, 0, 9}, shape(s, t), 0});
       }},
      {"disk",
       [=](Scene& s, const auto& t) {
         s.disks.push_back({{-1.5f, 2, 0}, {0, -1, 0}, 1, shape(s, t), 0});
       }},
      {"sphere",
       [=](Scene& s, const auto& t) {
         s.spheres.push_back({{-1.5f, 2, 0}, 1, shape(s, t), 0});
       }},
  };
}

Image under(const NamedLight& light, const Material& receiver, const LightTraits& traits) {
  Scene scene = origin_seen({receiver});
  light.add(scene, traits);
  return pixels(scene, {.max_bounces = 2});
}

// `scaled` is `factor`, a power of two, times `plain`, to the last bit; and there is light at all.
void expect_scaled(const Image& scaled, Image plain, float factor, const std::string& what) {
  EXPECT_TRUE(is_lit(plain)) << what;
  for (float& v : plain.data()) v *= factor;
  EXPECT_TRUE(same_bits(scaled, plain)) << what;
}

TEST(LightFactors, ScaleWhatTheirKindOfScatteringMakesOfALightExactly) {
  const Material paint{.base_color = kHalf}, mirror{.kind = Kind::mirror, .base_color = kHalf},
      metal{.kind = Kind::metal, .base_color = kHalf, .roughness = 0.5f};
  const LightTraits traits{.diffuse = 0.25f, .specular = 4};
  for (const NamedLight& light : named_lights()) {
    expect_scaled(under(light, paint, traits), under(light, paint, {}), 0.25f, light.name);
    expect_scaled(under(light, metal, traits), under(light, metal, {}), 4, light.name);
    if (light.in_mirrors)
      expect_scaled(under(light, mirror, traits), under(light, mirror, {}), 4, light.name);
  }
}

TEST(LightFactors, OfADiffuseAndASpecularHalfAddUpToTheWhole) {
  const Material plastic{.kind = Kind::plastic, .base_color = kHalf, .roughness = 0.5f};
  for (const NamedLight& light : named_lights()) {
    const Image diffuse = under(light, plastic, {.specular = 0}),
                specular = under(light, plastic, {.diffuse = 0}), both = under(light, plastic, {});
    EXPECT_TRUE(is_lit(diffuse) && is_lit(specular)) << light.name;
    for (std::size_t i = 0; i < both.data().size(); ++i)
      EXPECT_NEAR(diffuse.data()[i] + specular.data()[i], both.data()[i], 1e-5f * (1 + both.data()[i]))
          << light.name;
  }
}

TEST(LightFactors, DoNotChangeHowALightLooks) {
  for (const NamedLight& light : named_lights()) {
    if (!light.in_mirrors) continue;
    Scene plain = origin_seen({{.base_color = kBlack}});
    plain.cameras[0] = camera_at({0, 0.1f, 0}, {-1.5f, 2, 0}, 1);
    Scene scaled = plain;
    light.add(plain, {});
    light.add(scaled, {.diffuse = 0.25f, .specular = 4});
    expect_scaled(pixels(scaled), pixels(plain), 1, light.name);
  }
}

// Something above the origin of a mirror or of paint, and a light above that.
Scene with_lid(const Material& ground, const Object& lid, float radiance) {
  Scene scene = origin_seen({ground});
  const int material = add_material(scene, emitter({radiance, radiance, radiance}));
  scene.objects = {lid};
  add_mesh(scene, grid({-3, 1, 3}, {6, 0, 0}, {0, 0, -6}, 1, material));
  scene.instances.back().object = 0;
  scene.suns.push_back({{0, -1, 0}, {2, 2, 2}});
  return scene;
}

TEST(VisibilityInRenders, WhatTheCameraDoesNotSeeStillShinesAndIsMirrored) {
  const Material paint{.base_color = kHalf}, mirror{.kind = Kind::mirror, .base_color = kHalf};
  for (const Material& ground : {paint, mirror}) {
    const Scene seen = with_lid(ground, {}, 3), hidden = with_lid(ground, {.camera = false}, 3);
    EXPECT_TRUE(is_lit(pixels(seen)));
    EXPECT_TRUE(same_bits(pixels(seen), pixels(hidden)));
  }
  Scene above = with_lid(paint, {.camera = false, .shadow = false}, 0);
  above.cameras = {camera_at({0.3f, 3, 0}, {0, 0, 0}, 1e-3f)};
  expect_radiance(above, V3d(0.5 * 2 / kPi), "through what it does not see");
}

TEST(VisibilityInRenders, WhatScatteredRaysDoNotSeeIsNotInMirrorsButCastsItsShadow) {
  Scene mirrored = with_lid({.kind = Kind::mirror, .base_color = kHalf}, {.scattered = false}, 3);
  mirrored.environment.radiance = Color(8, 4, 2);
  expect_radiance(mirrored, {4, 2, 1}, "the sky in a mirror", 0, 8, 1e-6);
  expect_radiance(with_lid({.base_color = kHalf}, {.scattered = false}, 0), V3d(0), "its shadow");
  Scene above = with_lid({.base_color = kHalf}, {.scattered = false}, 3);
  above.cameras = {camera_at({0.3f, 3, 0}, {0, 0, 0}, 1e-3f)};
  expect_radiance(above, V3d(3), "itself", 0, 8, 1e-6);
}

TEST(VisibilityInRenders, WhatCastsNoShadowIsSeenAndLetsLightThrough) {
  expect_radiance(with_lid({.base_color = kHalf}, {.shadow = false}, 0), V3d(0.5 * 2 / kPi), "below it");
  expect_radiance(with_lid({.base_color = kHalf}, {}, 0), V3d(0), "below what casts one");
  Scene above = with_lid({.base_color = kHalf}, {.shadow = false}, 3);
  above.cameras = {camera_at({0.3f, 3, 0}, {0, 0, 0}, 1e-3f)};
  expect_radiance(above, V3d(3), "itself", 0, 8, 1e-6);
}

// Paint below, a surface of `material` above it, a sun and a sky.
Scene paint_and(const Material& material) {
  Scene scene = origin_seen({{.base_color = kHalf}});
  add_mesh(scene, grid({-3, 1, -3}, {6, 0, 0}, {0, 0, 6}, 1, add_material(scene, material)));
  scene.suns.push_back({Vec3(0.9f, -0.435889894f, 0), {2, 2, 2}, 0.2f});
  scene.environment.radiance = kWhite;
  return scene;
}

TEST(Regularise, ChangesNoBitWhereThereIsNothingGlossyBehindSomethingRough) {
  const Scene diffuse = paint_and({.base_color = kHalf});
  Scene mirrors = origin_seen({{.kind = Kind::mirror, .base_color = kHalf}});
  add_mesh(mirrors, grid({-3, 1, -3}, {6, 0, 0}, {0, 0, 6}, 1, 0));
  mirrors.environment.radiance = kWhite;
  for (const Scene& scene : {diffuse, mirrors}) {
    const Image plain = pixels(scene);
    EXPECT_TRUE(is_lit(plain));
    EXPECT_TRUE(same_bits(pixels(scene, {.regularise = 0.3f}), plain));
  }
}

TEST(Regularise, WidensWhatIsGlossyBehindSomethingRough) {
  const Scene scene = paint_and({.kind = Kind::mirror, .base_color = kHalf});
  EXPECT_FALSE(same_bits(pixels(scene, {.regularise = 0.3f}), pixels(scene)));
  // A lobe as wide as asked stays as it is.
  const Scene rough = paint_and({.kind = Kind::metal, .base_color = kHalf, .roughness = 0.6f});
  EXPECT_TRUE(same_bits(pixels(rough, {.regularise = 0.3f}), pixels(rough)));
}

// Roulette from the first bounce on or never: the mean is the same, of which the series is known.
TEST(Roulette, DoesNotChangeTheMean) {
  for (const int sure : {0, 2, 64}) {
    Scene scene;
    add_material(scene, {.base_color = kHalf, .emission = kWhite});
    scene.spheres.push_back({{0, 0, 0}, 1, 0});
    scene.cameras = {camera_at({0.2f, 0.1f, 0.3f}, {-0.3f, 0, -1}, 1)};
    const RenderSettings settings{.max_bounces = 64, .sure_bounces = sure};
    const Image seen = pixels(scene, settings, 512);
    double sum = 0, squares = 0;
    for (const float v : seen.plane(0)) sum += v, squares += double(v) * v;
    const double mean = sum / 64, error = std::sqrt((squares / 64 - mean * mean) / 64);
    EXPECT_NEAR(mean, 2, 4 * error + 1e-4) << sure;
  }
}

}  // namespace
}  // namespace tessera
