// SPDX-License-Identifier: Apache-2.0
#include "worker/render/warp.h"

#include "tests/worker/render/chi_squared.h"
#include "worker/render/camera.h"
#include "worker/render/light/distribution.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;

constexpr int kTries = 100000;

template <typename F>
std::vector<Vec2> drawn(F point) {
  Random random(17);
  std::vector<Vec2> points;
  for (int i = 0; i < kTries; ++i) points.push_back(point(random.pair()));
  return points;
}

double in_disc(double x, double y) {
  return std::hypot(2 * x - 1, 2 * y - 1) <= 1 ? 4 / std::numbers::pi : 0;
}

TEST(Warp, TheDiscIsUniform) {
  expect_follows(drawn([](const Vec2& u) { return disc(u) * 0.5f + Vec2(0.5f, 0.5f); }), kTries, in_disc,
                 "disc", 16, 200);
}

TEST(Warp, TheLensIsUniformAndItsRaysMeetAtTheFocus) {
  Camera camera;
  camera.to_world = Matrix().translate(Vec3(1, 2, 3));
  camera.lens_radius = 0.25f;
  camera.focus_distance = 4;
  const CameraRays rays({}, camera, {64, 32}, 0, 0);
  const auto on_lens = [&](const Vec2& u) {
    const Ray r = rays.ray(20, 9, u, 0);
    EXPECT_NEAR(r.origin.z, 3, 1e-6f);
    return Vec2(r.origin.x - 1, r.origin.y - 2) * (0.5f / 0.25f) + Vec2(0.5f, 0.5f);
  };
  expect_follows(drawn(on_lens), kTries, in_disc, "lens", 16, 200);
  const auto focus = [&](const Vec2& u) {
    const Ray r = rays.ray(20, 9, u, 0);
    return r.origin + r.direction * (-4 / r.direction.z);
  };
  EXPECT_LT(length(focus({0.1f, 0.9f}) - focus({0.7f, 0.3f})), 1e-5f);
}

// In units of a square about the unit circle; a regular polygon of n corners has the area n/2 sin(2 pi / n).
TEST(Warp, TheLensOfBladesIsUniformOnItsPolygon) {
  for (const int blades : {3, 5, 8}) {
    const Camera camera{.lens_radius = 0.5f, .blades = blades, .blade_rotation = 0.3f};
    const CameraRays rays({}, camera, {64, 32}, 0, 0);
    const double slice = 2 * std::numbers::pi / blades, area = blades / 2.0 * std::sin(slice);
    const auto density = [=](double x, double y) {
      const double a = 2 * x - 1, b = 2 * y - 1;
      const double turned = std::remainder(std::atan2(b, a) - 0.3 - slice / 2, slice);
      return std::hypot(a, b) * std::cos(turned) <= std::cos(slice / 2) ? 4 / area : 0.0;
    };
    const auto on_lens = [&](const Vec2& u) {
      const Ray r = rays.ray(20, 9, u, 0);
      return Vec2(r.origin.x, r.origin.y) + Vec2(0.5f, 0.5f);
    };
    expect_follows(drawn(on_lens), kTries, density, "blades", 16, 64);
  }
}

TEST(Warp, CosineConesAndTrianglesFollowTheirDensities) {
  expect_follows(drawn([](const Vec2& u) { return on_square(cosine_hemisphere(u)); }), kTries,
                 on_sphere([](const Vec3& d) { return std::max(0.0, d.z / std::numbers::pi); }), "cosine");
  expect_follows(
      drawn([](const Vec2& u) { return on_square(cone(u, 2)); }), kTries, [](double, double) { return 1.0; },
      "sphere");
  for (const float versine : {1e-6f, 0.01f, 0.5f, 1.7f}) {
    // In the cone's own measure: height and longitude are uniform.
    const auto point = [&](const Vec2& u) {
      const Vec3 d = cone(u, versine);
      const float sin2 = d.x * d.x + d.y * d.y;
      const float height = d.z > 0 ? sin2 / (1 + d.z) : 1 - d.z;
      return Vec2(on_square(d).x, height / versine);
    };
    expect_follows(
        drawn(point), kTries, [](double, double) { return 1.0; }, "cone");
  }
  expect_follows(
      drawn([](const Vec2& u) { return triangle(u); }), kTries,
      [](double x, double y) { return x + y <= 1 ? 2.0 : 0.0; }, "triangle", 16, 100);
}

TEST(Warp, SineAndCosineAreThoseOfTheLibrary) {
  for (float x = -kPi / 4; x <= kPi / 4; x += 0.001f) {
    EXPECT_NEAR(sin_cos_quarter(x).sin, std::sin(x), 1.2e-7f);
    EXPECT_NEAR(sin_cos_quarter(x).cos, std::cos(x), 1.2e-7f);
  }
}

TEST(Distribution, PicksInProportionAndHandsOnAUniformNumber) {
  const std::vector<float> weights{1, 0, 3, 0.5f, 0, 7.5f};
  const Distribution d(weights);
  const auto points = drawn([&](const Vec2& u) {
    const auto [index, share] = d.pick(u.x);
    EXPECT_GT(weights[index], 0);
    EXPECT_FLOAT_EQ(d.probability(index), weights[index] / 12);
    return Vec2((static_cast<float>(index) + 0.5f) / 6, share);
  });
  expect_follows(
      points, kTries, [&](double x, double) { return weights[std::size_t(x * 6)] / 12 * 6; }, "pick", 6, 12);
}

TEST(Distribution, WithoutAnyWeightEveryIndexIsAsLikely) {
  const Distribution d(std::vector<float>(4, 0.0f));
  EXPECT_EQ(d.pick(0).index, 0u);
  EXPECT_EQ(d.pick(0.99999f).index, 3u);
  EXPECT_EQ(d.probability(2), 0.25f);
}

}  // namespace
}  // namespace tessera::tracer
