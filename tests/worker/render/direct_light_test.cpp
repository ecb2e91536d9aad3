// SPDX-License-Identifier: Apache-2.0
// Direct light on a diffuse plane, where the irradiance is known in closed form.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/worker/render/scenes.h"

namespace tessera {
namespace {

using namespace testing;

constexpr float kAlbedo = 0.6f;

// A floor of which the camera sees one point, as good as.
Scene floor_scene(const Vec3& at = {0, 0, 0}) {
  Scene scene;
  add_floor(scene, Color(kAlbedo, kAlbedo, kAlbedo));
  scene.cameras = {camera_at(at + Vec3(0.3f, 3, 0.5f), at, 1e-3f)};
  return scene;
}

// The radiance that irradiance `e` makes the floor reflect.
void expect_irradiance(const Scene& scene, double e, const char* what, double slack = 2e-4,
                       int samples = 64) {
  const Measured m = measure(scene, 32, samples, 0);
  const double expected = kAlbedo * e / kPi;
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(m.mean[c], expected, 5 * m.error[c] + slack * expected) << what << ", channel " << c;
}

// A regular polygon, as good as a disc; front down.
void add_disc(Scene& scene, float height, float radius, bool double_sided, bool facing_down) {
  const int material = add_material(
      scene, {.base_color = Color(0, 0, 0), .emission = Color(2, 2, 2), .double_sided = double_sided});
  Mesh mesh{.positions = {{0, height, 0}}, .material = material};
  constexpr int kSides = 400;
  for (int i = 0; i < kSides; ++i)
    mesh.positions.push_back(
        {radius * std::cos(2 * kPi * i / kSides), height, radius * std::sin(2 * kPi * i / kSides)});
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t a = 1 + i, b = 1 + (i + 1) % kSides;
    // Seen from above, growing angles go clockwise: (centre, a, b) is front down.
    if (facing_down)
      mesh.triangles.push_back({0, a, b});
    else
      mesh.triangles.push_back({0, b, a});
  }
  add_mesh(scene, mesh);
}

TEST(DirectLight, OfAPointFallsWithTheSquareOfTheDistanceAndTheCosine) {
  Scene scene = floor_scene({1, 0, 2});
  scene.points.push_back({{0, 2, 0}, {9, 9, 9}});
  expect_irradiance(scene, 9.0 * 2 / 27, "point");  // distance 3: cos = 2/3
}

TEST(DirectLight, OfASpotIsFullWithinAndZeroBeyondItsCones) {
  const auto with_spot = [](float x) {
    Scene scene = floor_scene({x, 0, 0});
    scene.spots.push_back({{0, 2, 0}, {0, -1, 0}, {4, 4, 4}, 0.3f, 0.6f});
    return scene;
  };
  const auto plain = [](double x) { return 4 * 2 / std::pow(4 + x * x, 1.5); };
  expect_irradiance(with_spot(0), plain(0), "axis");
  expect_irradiance(with_spot(2 * std::tan(0.28f)), plain(2 * std::tan(0.28)), "inside the inner cone");
  expect_irradiance(with_spot(2 * std::tan(0.65f)), 0, "outside");
  // KHR_lights_punctual: the square of the cosine's way from the outer to the inner cone.
  const double t = (std::cos(0.45) - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6));
  expect_irradiance(with_spot(2 * std::tan(0.45f)), plain(2 * std::tan(0.45)) * t * t, "between", 2e-3);
}

TEST(DirectLight, OfASunIsItsIrradianceTimesTheCosineWhateverItsDiameter) {
  for (const float diameter : {0.0f, 5e-5f, 0.00925f, 0.3f, 1.2f}) {
    Scene scene = floor_scene();
    scene.suns.push_back({Vec3(0.6f, -0.8f, 0), {2, 2, 2}, diameter});
    expect_irradiance(scene, 1.6, "sun");
  }
}

TEST(DirectLight, OfASphereIsThatOfItsSolidAngle) {
  for (const float radius : {0.01f, 0.5f, 1.4f}) {
    Scene scene = floor_scene({1.5f, 0, 0});
    const int lamp = add_material(scene, {.base_color = Color(0, 0, 0), .emission = Color(3, 3, 3)});
    scene.spheres.push_back({{0, 2, 0}, radius, lamp});
    expect_irradiance(scene, 3 * kPi * radius * radius / 6.25 * 0.8, "sphere");  // distance 2.5, cos 0.8
  }
}

TEST(DirectLight, OfADiscAboveItsCentreIsKnown) {
  for (const float radius : {0.1f, 1.0f, 5.0f})
    for (const bool double_sided : {false, true}) {
      Scene scene = floor_scene();
      scene.cameras = {camera_at({0, 0.6f, 0.4f}, {0, 0, 0}, 1e-3f)};
      add_disc(scene, 1, radius, double_sided, true);
      expect_irradiance(scene, 2 * kPi * radius * radius / (1 + radius * radius), "disc", 1e-3, 256);
    }
}

TEST(DirectLight, ComesFromTheBackOfALightOnlyIfItIsDoubleSided) {
  Scene scene = floor_scene();
  scene.cameras = {camera_at({0, 0.6f, 0.4f}, {0, 0, 0}, 1e-3f)};
  Scene twice = scene;
  add_disc(scene, 1, 1, false, false);
  expect_irradiance(scene, 0, "back of a single-sided light");
  add_disc(twice, 1, 1, true, false);
  expect_irradiance(twice, kPi, "back of a double-sided light", 1e-3);
}

// The differential of a parallel rectangle above one of its corners; Siegel and Howell, configuration B-4.
double corner_factor(double a, double b, double height) {
  const double x = a / height, y = b / height, p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
  return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2 * std::numbers::pi);
}

TEST(DirectLight, OfARectangleToTheSideComesFromAllOfItsTriangles) {
  for (const bool others : {false, true}) {
    Scene scene = floor_scene();
    const int lamp = add_material(scene, {.base_color = Color(0, 0, 0), .emission = Color(2, 2, 2)});
    // Over x in [1, 3] and z in [-0.5, 2], at a height of 1.5; uneven triangles.
    Mesh light = grid({1, 1.5f, -0.5f}, {2, 0, 0}, {0, 0, 2.5f}, 5, lamp);
    for (Vec3& p : light.positions) p.x = 1 + (p.x - 1) * (p.x - 1) / 2;
    add_mesh(scene, light);
    if (others) scene.points.push_back({{-1, 2, 1}, {1, 1, 1}});
    const auto strip = [](double z) { return corner_factor(3, z, 1.5) - corner_factor(1, z, 1.5); };
    const double e = 2 * std::numbers::pi * (strip(2) + strip(0.5));
    expect_irradiance(scene, e + (others ? 2 / std::pow(6, 1.5) : 0), "rectangle", 2e-3, 512);
  }
}

TEST(DirectLight, OfAConstantSkyIsPiTimesItsRadiance) {
  Scene scene = floor_scene();
  scene.environment.radiance = Color(0.7f, 0.7f, 0.7f);
  expect_irradiance(scene, 0.7 * kPi, "constant");
}

Scene under_picture(Picture picture, float rotation) {
  Scene scene = floor_scene();
  scene.environment = {Color(2, 2, 2), 0, rotation};
  scene.pictures.push_back(std::move(picture));
  return scene;
}

TEST(DirectLight, OfAPictureIsTheIntegralOfThePicture) {
  expect_irradiance(under_picture({"grey", 8, 4, 3, std::vector<float>(96, 0.35f)}, 1), 0.7 * kPi,
                    "constant");
  // A bright patch on a dim sky; the picture is interpolated between the centres of its pixels.
  constexpr int kWidth = 64, kHeight = 32;
  Picture sky{"patch", kWidth, kHeight, 1, std::vector<float>(kWidth * kHeight, 0.05f)};
  for (int y = 4; y < 9; ++y)
    for (int x = 20; x < 25; ++x) sky.pixels[static_cast<std::size_t>(y * kWidth + x)] = 30;
  double e = 0;
  constexpr int kSteps = 2048;
  for (int j = 0; j < kSteps / 2; ++j) {  // the upper hemisphere
    const double v = (j + 0.5) / kSteps, theta = v * kPi;
    const double row = v * kHeight - 0.5;
    const int y = std::max(0, static_cast<int>(std::floor(row)));
    const double share = std::max(0.0, row - y);
    for (int x = 0; x < kWidth; ++x) {  // a row's mean is that of its pixels
      const double a = sky.pixels[std::size_t(y * kWidth + x)],
                   b = sky.pixels[std::size_t((y + 1) * kWidth + x)];
      e +=
          2 * (a + (b - a) * share) * std::sin(theta) * std::cos(theta) * (kPi / kSteps) * (2 * kPi / kWidth);
    }
  }
  for (const float rotation : {0.0f, 2.0f})
    expect_irradiance(under_picture(sky, rotation), e, "patch", 1e-3, 256);
}

TEST(DirectLight, OfManyKindsOfLightAddsUp) {
  Scene scene = floor_scene();
  scene.points.push_back({{0, 2, 0}, {4, 4, 4}});           // 1
  scene.suns.push_back({Vec3(0, -1, 0), {1, 1, 1}, 0.1f});  // 1
  const int lamp = add_material(scene, {.base_color = Color(0, 0, 0), .emission = Color(2, 2, 2)});
  scene.spheres.push_back({{1.5f, 2, 0}, 0.5f, lamp});  // 2 pi 0.25 / 6.25 * 0.8
  scene.environment.radiance = Color(0.2f, 0.2f, 0.2f);
  // The sphere hides its own solid angle of sky.
  const double lamp_e = (2 - 0.2) * kPi * 0.25 / 6.25 * 0.8;
  expect_irradiance(scene, 1 + 1 + lamp_e + 0.2 * kPi, "together", 1e-3, 1024);
}

TEST(DirectLight, IsBlockedByWhatStandsBetween) {
  Scene scene = floor_scene();
  scene.points.push_back({{0, 5, 0}, {4, 4, 4}});
  scene.suns.push_back({Vec3(0, -1, 0), {1, 1, 1}, 0.01f});
  add_mesh(scene, grid({-1, 4, 1}, {2, 0, 0}, {0, 0, -2}, 3, 0));
  expect_irradiance(scene, 0, "shadow");
}

}  // namespace
}  // namespace tessera
