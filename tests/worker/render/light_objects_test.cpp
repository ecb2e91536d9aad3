// SPDX-License-Identifier: Apache-2.0
// Lights as objects: who sees them, whose light it is, and that it is the same however they are picked.
#include <set>

#include "tests/worker/render/irradiance.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;
using Imath::V3d;
using tessera::testing::kPi;

TEST(LightObjects, ALightThatTheCameraDoesNotSeeLightsAllTheSame) {
  Scene scene = with_lamp();
  scene.objects = {{.camera = false}};
  scene.quads.push_back(kRectangle);
  scene.quads[0].object = 0;
  EXPECT_FALSE(look(*prepared(scene), kAt, {0, 1, 0}, {.kind = RayKind::camera}));
  EXPECT_TRUE(look(*prepared(scene), kAt, {0, 1, 0}, {.kind = RayKind::scattered}));
  expect_all(scene, {0, 1, 0}, polygon(kRectangle, {0, 1, 0}), "not seen by the camera");
}

TEST(LightObjects, ALightThatNobodySeesLightsAllTheSame) {
  Scene scene = with_lamp();
  scene.objects = {{.camera = false, .scattered = false, .shadow = false}};
  scene.quads.push_back({{-3, 3, -1}, {0.5f, 0, 0}, {0, 0, 0.5f}});
  scene.quads.push_back(kRectangle);
  scene.quads[0].object = scene.quads[1].object = 0;
  scene.disks.push_back({kAt + Vec3(0, 4, 0), {0, -1, 0}, 0.5f, 0, 0});  // above the rectangle
  expect_sampled(
      scene, {0, 1, 0},
      polygon(kRectangle, {0, 1, 0}) + polygon(scene.quads[0], {0, 1, 0}) + 2 * kPi * disk_factor(0.5, 4, 0),
      "not seen at all");
}

TEST(LightObjects, ALightThatScatteredRaysDoNotSeeIsSampledWithoutAWeight) {
  Scene scene = with_lamp();
  scene.objects = {{.scattered = false}, {}};
  scene.quads.push_back(kRectangle);
  scene.spheres.push_back({kAt + Vec3(-3, 2, 0), 0.5f});
  add_mesh(scene, grid({2, 2, 0}, {1, 0, 0}, {0, 0, 1}, 1, 0));
  scene.quads[0].object = scene.spheres[0].object = scene.instances[0].object = 0;
  const double known = polygon(kRectangle, {0, 1, 0}) + 2 * kPi * 0.25 / 13 * (2 / std::sqrt(13)) +
                       polygon(Quad{{2, 2, 0}, {1, 0, 0}, {0, 0, 1}}, {0, 1, 0});
  expect_sampled(scene, {0, 1, 0}, known, "not seen by scattered rays");
}

TEST(LightObjects, ALightThatCastsNoShadowLetsOthersThrough) {
  Scene scene = with_lamp();
  scene.objects = {{.shadow = false}};
  scene.quads.push_back(kRectangle);
  scene.points.push_back({kAt + Vec3(0, 4, 0), {16, 16, 16}});
  const double lamp = polygon(kRectangle, {0, 1, 0});
  const auto by_light = [&] { return measured(*prepared(scene), {0, 1, 0}).by_light; };
  const Mean in_shadow = by_light();
  EXPECT_NEAR(in_shadow.mean(), lamp, 4 * in_shadow.error());
  scene.quads[0].object = 0;
  const Mean through = by_light();
  EXPECT_NEAR(through.mean(), lamp + 1, 4 * through.error());
}

// Each light of its own group, asked for by what a sample and a hit say.
TEST(LightObjects, KnowsWhoseLightItIs) {
  Scene scene = with_lamp();
  for (int i = 0; i < 4; ++i) scene.objects.push_back({.light = {.group = i}});
  scene.quads.push_back({{-2, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, 0, 0});
  scene.disks.push_back({{2, 2, 0}, {0, -1, 0}, 0.5f, 0, 1});
  scene.spheres.push_back({{0, 2, 3}, 0.5f, 0, 2});
  add_mesh(scene, grid({0, 2, -3}, {1, 0, 0}, {0, 0, 1}, 2, 0));
  scene.instances[0].object = 3;
  scene.points.push_back({{5, 2, 0}, {1, 1, 1}, {.group = 4}});
  scene.spots.push_back({{-5, 2, 0}, {0, -1, 0}, {1, 1, 1}, 0.5f, 1.5f, {.group = 5}});
  scene.suns.push_back({unit(Vec3(-0.3f, -1, 0.1f)), {1, 1, 1}, 0.1f, true, {.group = 6}});
  scene.environment.radiance = Color(1, 1, 1);
  scene.environment.light.group = 7;
  const auto ready = prepared(scene);
  const Lights& lights = ready->lights();
  Random random(59);
  std::set<int> sampled;
  for (int i = 0; i < 4000; ++i) {
    const float pick = random.number();
    const LightSample l = lights.sample(kAt, {0, 1, 0}, pick, random.pair());
    if (!(l.pdf > 0)) continue;
    sampled.insert(l.traits->group);
    if (l.delta) continue;
    const auto seen = look(*ready, kAt, l.direction, {.kind = RayKind::scattered});
    if (!l.infinite && seen && seen->surface.light >= 0) {
      EXPECT_EQ(lights.hit({kAt, {0, 1, 0}, 1}, l.direction, seen->surface).traits->group, l.traits->group);
    }
  }
  EXPECT_EQ(sampled, (std::set<int>{0, 1, 2, 3, 4, 5, 6}));
  std::set<int> around;
  lights.escaped({kAt, {0, 1, 0}, 1}, unit(Vec3(0.3f, 1, -0.1f)),
                 [&](const Emitted& e) { around.insert(e.traits->group); });
  EXPECT_EQ(around, (std::set<int>{6, 7}));
}

// Lamps of all kinds about a point, some of them hidden behind a wall.
Scene many_lamps() {
  Scene scene = with_lamp();
  add_material(scene, {});
  Random random(61);
  const auto place = [&] {
    return Vec3(8 * random.number() - 4, 1 + 2 * random.number(), 8 * random.number() - 4);
  };
  for (int i = 0; i < 25; ++i) {
    scene.points.push_back({place(), Color(1, 1, 1) * random.number()});
    scene.spots.push_back({place(), unit(Vec3(random.number() - 0.5f, -1, 0)), {2, 2, 2}, 0.3f, 0.9f});
    scene.spheres.push_back({place(), 0.2f * random.number()});
    scene.quads.push_back({place(), {0.3f, 0, 0}, {0, 0.1f, 0.3f * random.number()}});
    scene.disks.push_back({place(), unit(Vec3(random.number() - 0.5f, -1, 0)), 0.2f});
  }
  add_mesh(scene, grid({-2, 2, -2}, {1, 0, 0}, {0, 0, 1}, 4, 0));
  add_mesh(scene, grid({1, 0, -4}, {0, 3, 0}, {0, 0, 8}, 1, 1));
  scene.suns.push_back({unit(Vec3(-0.3f, -1, 0.1f)), {1, 1, 1}, 0.2f});
  return scene;
}

TEST(LightObjects, IsTheSameHoweverLightsArePickedAndTheTreeIsTheSurest) {
  const auto scene = std::make_shared<const Scene>(many_lamps());
  const RenderScene tree(scene), power(scene, {}, LightChoice::power),
      uniform(scene, {}, LightChoice::uniform);
  const Vec3 n = unit(Vec3(0.2f, 1, 0.1f));
  const Irradiance a = measured(tree, n), b = measured(power, n), c = measured(uniform, n);
  for (const Irradiance* other : {&b, &c}) {
    EXPECT_NEAR(a.by_light.mean(), other->by_light.mean(),
                4 * std::hypot(a.by_light.error(), other->by_light.error()));
    EXPECT_NEAR(a.by_both.mean(), other->by_both.mean(),
                4 * std::hypot(a.by_both.error(), other->by_both.error()));
    EXPECT_LT(a.by_light.error(), other->by_light.error());
  }
  EXPECT_NEAR(a.by_both.mean(), a.by_light.mean(), 4 * std::hypot(a.by_both.error(), a.by_light.error()));
}

}  // namespace
}  // namespace tessera::tracer
