// SPDX-License-Identifier: Apache-2.0
// Cameras, backgrounds, catchers, and the options that bend the light.
#include <gtest/gtest.h>

#include "tests/worker/render/scenes.h"
#include "worker/render/camera.h"

namespace tessera {
namespace {

using namespace testing;
using tracer::CameraRays;
using tracer::Ray;

constexpr int kEdge = 16;

struct Shot {
  Image sums;
  FilmLayout layout;

  Vec3 color(int x, int y, Aov aov = Aov::color) const {
    const Image m = developed(sums, layout, channels_of(aov), Part::all);
    return {m.at(0, x, y), m.at(1, x, y), m.at(2, x, y)};
  }
  float alpha(int x, int y) const {
    const auto sum = [&](int plane) { return sums.at(plane, x, y) + sums.at(plane + 1, x, y); };
    return sum(FilmLayout::hits(Half::a)) / sum(FilmLayout::count(Half::a));
  }
};
Shot shot(const Scene& scene, RenderSettings settings, int samples = 64) {
  settings.size = {kEdge, kEdge};
  return {render(*prepared(scene), settings, 0, {0, 0, kEdge, kEdge}, {0, samples}).sums,
          FilmLayout(settings.aovs)};
}

void expect_near(const Vec3& a, const Vec3& b, float most) { EXPECT_LT((a - b).length(), most) << a << b; }

TEST(View, OrthographicRaysAreParallelAndAsFarApartAsTheHeightSays) {
  Camera camera{.projection = Camera::Projection::orthographic, .height = 4};
  const CameraRays rays({}, camera, {200, 100}, 0, 0);
  const Ray a = rays.ray(0, 0, {}, 0), b = rays.ray(200, 100, {}, 0);
  expect_near(a.origin, {-4, 2, 0}, 1e-5f);
  expect_near(b.origin, {4, -2, 0}, 1e-5f);
  expect_near(a.direction, {0, 0, -1}, 1e-6f);
  camera.width = 2;
  expect_near(CameraRays({}, camera, {200, 100}, 0, 0).ray(200, 0, {}, 0).origin, {1, 0.5f, 0}, 1e-5f);
}

TEST(View, APanoramaSeesAllDirectionsAndWraps) {
  const Camera camera{.projection = Camera::Projection::panorama};
  const CameraRays rays({}, camera, {360, 180}, 0, 0);
  const auto direction = [&](float x, float y) { return rays.ray(x, y, {}, 0).direction; };
  expect_near(direction(180, 90), {0, 0, -1}, 1e-5f);
  expect_near(direction(270, 90), {1, 0, 0}, 1e-5f);
  expect_near(direction(180, 0), {0, 1, 0}, 1e-5f);
  expect_near(direction(0, 90), direction(360, 90), 1e-5f);
  const auto seen = rays.pixel(direction(359, 40) * 7.0f, 0, {1, 40});
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->x, -1, 1e-2f) << "the copy next to the left edge";
  EXPECT_NEAR(seen->y, 40, 1e-2f);
}

TEST(View, PixelIsTheInverseOfRayForEveryProjection) {
  for (const auto projection :
       {Camera::Projection::perspective, Camera::Projection::orthographic, Camera::Projection::panorama}) {
    Camera camera = camera_at({1, 2, 3}, {-4, 1, -2}, 0.8f);
    camera.projection = projection;
    const CameraRays rays({}, camera, {64, 48}, 0, 0);
    const Ray r = rays.ray(11.25f, 40.5f, {}, 0);
    const auto seen = rays.pixel(r.origin + r.direction * 9.0f, 0, {11, 40});
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->x, 11.25f, 1e-3f);
    EXPECT_NEAR(seen->y, 40.5f, 1e-3f);
  }
}

TEST(View, BladesMakeThePolygonTheyAre) {
  Camera camera{.lens_radius = 1, .blades = 4, .focus_distance = 1};
  const CameraRays rays({}, camera, {10, 10}, 0, 0);
  int beyond = 0;
  float furthest = 0;
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const Vec2 u((static_cast<float>(i) + 0.5f) / 64, (static_cast<float>(j) + 0.5f) / 64);
      const Vec3 at = rays.ray(5, 5, u, 0).origin;
      beyond += std::abs(at.x) + std::abs(at.y) > 1 + 1e-5f;  // a square that stands on its corner
      furthest = std::max(furthest, std::abs(at.x) + std::abs(at.y));
    }
  EXPECT_EQ(beyond, 0);
  EXPECT_GT(furthest, 0.95f);
}

// Two walls, of which the near one covers the left half of the view.
Scene near_and_far() {
  Scene scene;
  Material bright{.emission = Color(1, 0, 0)}, dark{.emission = Color(0, 0, 1)};
  add_mesh(scene, grid({-9, -9, -2}, {9, 0, 0}, {0, 18, 0}, 1, add_material(scene, bright)));
  add_mesh(scene, grid({-90, -90, -20}, {180, 0, 0}, {0, 180, 0}, 1, add_material(scene, dark)));
  scene.cameras = {camera_at({0, 0, 0}, {0, 0, -1}, 0.6f)};
  return scene;
}

// The share of the lens that sees past an edge in the plane x = 0 at depth `edge`, focused at `focus`, for a
// ray through slope s: a point (x, y) of the lens looks at (s * focus - x) / focus, and at the edge is at
// x (1 - edge / focus) + s * edge.
double share_right(double s, double edge, double focus, double radius) {
  const double scale = 1 - edge / focus;
  int right = 0, all = 0;
  for (int i = 0; i < 400; ++i)
    for (int j = 0; j < 400; ++j) {
      const double x = (i + 0.5) / 200 - 1, y = (j + 0.5) / 200 - 1;
      if (x * x + y * y > 1) continue;
      ++all;
      right += x * radius * scale + s * edge > 0;
    }
  return double(right) / all;
}

TEST(View, DepthOfFieldIsThatOfBruteForceOverTheLens) {
  Scene scene = near_and_far();
  scene.cameras[0].lens_radius = 0.2f;
  scene.cameras[0].focus_distance = 20;
  const int samples = 1024;
  const Shot s = shot(scene, {.max_bounces = 0, .aovs = {Aov::color}}, samples);
  const double pixel = 2 * std::tan(0.3) / kEdge;
  for (const int x : {6, 7, 8, 9}) {
    double expected = 0;
    for (int k = 0; k < 32; ++k) expected += share_right((x + (k + 0.5) / 32 - 8) * pixel, 2, 20, 0.2) / 32;
    const double error = std::sqrt(expected * (1 - expected) / samples) + 1e-3;
    EXPECT_NEAR(s.color(x, 8).z, expected, 4 * error) << x;
  }
}

TEST(View, AutofocusIsOnWhatTheMiddleShows) {
  Scene scene = near_and_far();
  scene.instances.erase(scene.instances.begin());  // the far wall only, at 20 m
  Camera& camera = scene.cameras[0];
  camera.lens_radius = 0.3f;
  camera.focus_distance = 20;
  const RenderSettings settings{.max_bounces = 0, .aovs = {Aov::position}};
  const Shot by_hand = shot(scene, settings, 32);
  camera.focus_distance = 1;
  const Shot unfocused = shot(scene, settings, 32);
  camera.autofocus = true;
  const Shot automatic = shot(scene, settings, 32);
  expect_near(automatic.color(3, 4, Aov::position), by_hand.color(3, 4, Aov::position), 1e-3f);
  EXPECT_GT((unfocused.color(3, 4, Aov::position) - by_hand.color(3, 4, Aov::position)).length(), 1e-2f);
}

TEST(Background, HidesTheEnvironmentFromTheCameraOnly) {
  Scene scene;
  add_floor(scene, {0.5f, 0.5f, 0.5f});
  scene.environment.radiance = Color(1, 1, 1);
  scene.cameras = {camera_at({0, 1, 0}, {0, 1, -1}, 1.0f)};
  const RenderSettings settings{.max_bounces = 0, .aovs = {Aov::color}};
  const Shot lit = shot(scene, settings);
  expect_near(lit.color(8, 2), {1, 1, 1}, 1e-6f);
  scene.background = {Background::Kind::color, Color(0.1f, 0.2f, 0.3f)};
  const Shot coloured = shot(scene, settings);
  expect_near(coloured.color(8, 2), {0.1f, 0.2f, 0.3f}, 1e-6f);
  EXPECT_EQ(coloured.color(8, 14), lit.color(8, 14)) << "the floor is lit as before";
  scene.background.kind = Background::Kind::transparent;
  const Shot cut = shot(scene, settings);
  EXPECT_EQ(cut.color(8, 2), Vec3(0, 0, 0));
  EXPECT_EQ(cut.alpha(8, 2), 0);
  EXPECT_EQ(cut.alpha(8, 14), 1);
}

TEST(Background, IsSeenByTheCameraAndNotInAMirror) {
  Scene scene;
  const int mirror = add_material(scene, {.kind = Material::Kind::mirror, .base_color = Color(1, 1, 1)});
  add_mesh(scene, grid({-50, -50, -5}, {100, 0, 0}, {0, 100, 0}, 1, mirror));
  scene.environment.radiance = Color(2, 2, 2);
  scene.background = {Background::Kind::color, Color(0, 0, 0)};
  scene.cameras = {camera_at({0, 0, 0}, {0, 0, -1}, 0.5f)};
  expect_near(shot(scene, {.aovs = {Aov::color}}).color(4, 4), {2, 2, 2}, 1e-5f);
}

// A floor that catches the shadow of a large disc of a wall, under a sun at the zenith.
Scene caught(bool shaded) {
  Scene scene;
  scene.objects = {{.name = "ground", .catcher = true}, {.name = "roof", .camera = false}};
  add_floor(scene, {0.5f, 0.5f, 0.5f});
  scene.instances[0].object = 0;
  if (shaded) {
    add_mesh(scene, grid({-50, 30, 50}, {100, 0, 0}, {0, 0, -100}, 1, 0));
    scene.instances[1].object = 1;
  }
  scene.suns.push_back({.direction = {0, -1, 0}, .irradiance = {1, 1, 1}});
  scene.background.kind = Background::Kind::transparent;
  scene.cameras = {camera_at({0, 4, 0}, {0, 0, -1}, 0.3f)};
  return scene;
}

TEST(Catcher, IsInvisibleInTheLightAndBlackInTheShadow) {
  const RenderSettings settings{.aovs = {Aov::color, Aov::depth}};
  const Shot lit = shot(caught(false), settings);
  EXPECT_EQ(lit.alpha(8, 8), 0);
  EXPECT_EQ(lit.color(8, 8), Vec3(0, 0, 0));
  const Shot dark = shot(caught(true), settings);
  EXPECT_EQ(dark.alpha(8, 8), 1);
  EXPECT_EQ(dark.color(8, 8), Vec3(0, 0, 0));
  Scene before_colour = caught(false);
  before_colour.background = {Background::Kind::color, Color(0.3f, 0.6f, 0.9f)};
  expect_near(shot(before_colour, settings).color(8, 8), {0.3f, 0.6f, 0.9f}, 1e-6f);
}

TEST(Catcher, IsAsDarkAsTheShareOfLightThatIsMissing) {
  // Half of the irradiance comes from the sun, which is covered; half from a sky of 1 / pi, of which the roof
  // hides nothing that counts: it is small and far up.
  Scene scene = caught(true);
  scene.meshes[1] = grid({-2, 200, 2}, {4, 0, 0}, {0, 0, -4}, 1, 0);
  scene.environment.radiance = Color(1 / kPi, 1 / kPi, 1 / kPi);
  scene.cameras = {camera_at({0, 0.5f, 0}, {0, 0, 0}, 0.1f)};
  const int samples = 4096;
  const Shot s = shot(scene, {.aovs = {Aov::color}}, samples);
  double sum = 0;
  for (int y = 0; y < kEdge; ++y)
    for (int x = 0; x < kEdge; ++x) sum += s.alpha(x, y);
  EXPECT_NEAR(sum / (kEdge * kEdge), 0.5, 4 * 0.5 / std::sqrt(double(samples) * kEdge * kEdge) + 0.01);
}

TEST(Clamping, BoundsWhatASampleAddsAndIsOffByDefault) {
  Scene scene;
  add_floor(scene, {1, 1, 1});
  scene.suns.push_back({.direction = {0, -1, 0}, .irradiance = {kPi * 8, kPi * 4, kPi * 2}});
  scene.cameras = {camera_at({0, 4, 0}, {0, 0, -1}, 0.3f)};
  RenderSettings settings{.max_bounces = 0, .aovs = {Aov::color}};
  expect_near(shot(scene, settings).color(4, 4), {8, 4, 2}, 1e-4f);
  settings.clamp_direct = 2;
  expect_near(shot(scene, settings).color(4, 4), {2, 1, 0.5f}, 1e-5f);
  settings.clamp_direct = 0;
  settings.clamp_indirect = 1e-3f;
  expect_near(shot(scene, settings).color(4, 4), {8, 4, 2}, 1e-4f);
}

}  // namespace
}  // namespace tessera
