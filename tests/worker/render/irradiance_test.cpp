// SPDX-License-Identifier: Apache-2.0
// Irradiance by every kind of light where it is known in closed form. All to four standard errors.
#include "tests/worker/render/irradiance.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;
using Imath::V3d;
using tessera::testing::kPi;

TEST(Irradiance, OfQuads) {
  for (const Quad& quad : {kRectangle, kParallelogram, Quad{{-3, 0.2f, -3}, {6, 0, 0}, {0, 0, 6}},
                           Quad{{30, 100, 20}, {0.1f, 0, 0}, {0, 0, 0.2f}}}) {
    Scene scene = with_lamp();
    scene.quads.push_back(quad);
    const Vec3 n = unit(Vec3(0.05f, 1, 0.05f));
    const Irradiance e = measured(*prepared(scene), n);
    const double known = polygon(quad, n);
    EXPECT_NEAR(e.by_light.mean(), known, 4 * e.by_light.error() + 1e-4 * known);
    EXPECT_NEAR(e.by_both.mean(), known, 4 * e.by_both.error() + 1e-4 * known);
    EXPECT_NEAR(e.by_hit.mean(), known, 4 * e.by_hit.error() + 2e-5);
  }
}

TEST(Irradiance, OfTheTrianglesOfAMesh) {
  Scene scene = with_lamp();
  add_mesh(scene, grid(kParallelogram.corner, kParallelogram.edge_u, kParallelogram.edge_v, 3, 0),
           Matrix().scale(Vec3(1, 1, 1)) * Matrix().translate(Vec3(0, 1, 0)));
  Quad higher = kParallelogram;
  higher.corner.y += 1;
  expect_all(scene, {0, 1, 0}, polygon(higher, {0, 1, 0}), "mesh");
}

TEST(Irradiance, OfAMeshOfMoreTrianglesThanAreLightsOfTheirOwn) {
  Scene scene = with_lamp();
  Mesh fine = grid(kParallelogram.corner, kParallelogram.edge_u, kParallelogram.edge_v, 730, 0);
  for (Vec3& p : fine.positions) p.x = -1 + (p.x + 1) * (p.x + 1) / 2.5f;  // uneven ones
  const auto stretched = [](const Vec3& p) { return Vec3(p.x, 0.5f * p.y + 1, 1.5f * p.z); };
  add_mesh(scene, std::move(fine), Matrix().scale(Vec3(1, 0.5f, 1.5f)) * Matrix().translate(Vec3(0, 1, 0)));
  ASSERT_GT(scene.meshes[0].triangles.size(), std::size_t{1} << 20);
  const Quad small{{2, 2, 0}, {1, 0, 0}, {0, 0, 1}};
  for (int i = 0; i < 2; ++i)  // more than two lights: the tree picks
    add_mesh(scene, grid(small.corner + small.edge_u * float(i), small.edge_u, small.edge_v, 1, 0));
  // The rim of the sheet as it was bent, in short straight pieces.
  std::vector<V3d> rim;
  constexpr int kPieces = 730;
  const auto along = [&](float u, float v) {
    Vec3 p = kParallelogram.corner + kParallelogram.edge_u * u + kParallelogram.edge_v * v;
    p.x = -1 + (p.x + 1) * (p.x + 1) / 2.5f;
    rim.emplace_back(stretched(p));
  };
  for (int i = 0; i < kPieces; ++i) along(float(i) / kPieces, 0);
  along(1, 0);
  for (int i = 0; i <= kPieces; ++i) along(1 - float(i) / kPieces, 1);
  const double known = polygon(rim, {0, 1, 0}) + polygon(small, {0, 1, 0}) +
                       polygon(Quad{{3, 2, 0}, {1, 0, 0}, {0, 0, 1}}, {0, 1, 0});
  expect_all(scene, {0, 1, 0}, known, "fine mesh", kAt, 1e-3);
}

TEST(Irradiance, OfDisksAboveAndToTheSide) {
  for (const float aside : {0.0f, 0.7f, 4.0f})
    for (const float radius : {0.2f, 1.5f}) {
      Scene scene = with_lamp();
      scene.disks.push_back({kAt + Vec3(aside, 1.2f, 0), {0, -1, 0}, radius});
      expect_all(scene, {0, 1, 0}, 2 * kPi * disk_factor(radius, 1.2f, aside), "disk", kAt, 1e-4);
    }
}

TEST(Irradiance, OfSpheresFromOutsideAndFromInside) {
  Scene scene = with_lamp();
  scene.spheres.push_back({kAt + Vec3(1, 2, 0), 0.8f});
  expect_all(scene, {0, 1, 0}, 2 * kPi * 0.64 / 5 * (2 / std::sqrt(5)), "outside", kAt, 1e-4);
  Scene inside = with_lamp(true);
  inside.spheres.push_back({kAt + Vec3(0.5f, 0.2f, 0), 2});
  expect_all(inside, {0, 1, 0}, 2 * kPi, "inside");
}

TEST(Irradiance, OfPointsSpotsAndSuns) {
  Scene point, spot, sun, disc, sky;
  point.points.push_back({kAt + Vec3(1, 2, 0), {5, 5, 5}});
  expect_sampled(point, {0, 1, 0}, 5 * 2 / std::pow(5, 1.5), "point");
  spot.spots.push_back({kAt + Vec3(1, 2, 0), -unit(Vec3(1, 2, 0)), {5, 5, 5}, 0.1f, 0.3f});
  expect_sampled(spot, {0, 1, 0}, 5 * 2 / std::pow(5, 1.5), "spot");
  sun.suns.push_back({unit(Vec3(0.6f, -0.8f, 0)), {3, 3, 3}});
  expect_sampled(sun, {0, 1, 0}, 2.4, "sun without extent");
  disc.suns.push_back({unit(Vec3(0.6f, -0.8f, 0)), {3, 3, 3}, 0.8f});
  expect_all(disc, {0, 1, 0}, 2.4, "sun with a disc");
}

TEST(Irradiance, OfTheBackOfASingleSidedLightIsNone) {
  for (const bool double_sided : {false, true}) {
    Scene scene = with_lamp(double_sided);
    Quad quad = kRectangle;
    quad.edge_u = -quad.edge_u;
    scene.quads.push_back(quad);
    scene.disks.push_back({kAt + Vec3(4, 1, 0), {0, 1, 0}, 0.5f});
    const double known = polygon(quad, {0, 1, 0}) + 2 * kPi * disk_factor(0.5, 1, 4);
    expect_all(scene, {0, 1, 0}, double_sided ? known : 0, "back", kAt, 1e-4);
  }
}

// Sampling finds lights behind the surface as well: light may come through it.
TEST(Irradiance, FromBelowIsSampledToo) {
  Scene scene = with_lamp();
  scene.quads.push_back(kRectangle);
  const auto ready = prepared(scene);
  int found = 0;
  for (int i = 0; i < 100; ++i)
    found += ready->lights().sample(kAt, {0, -1, 0}, 0.5f, {float(i) / 100, 0.5f}).pdf > 0;
  EXPECT_EQ(found, 100);
}

TEST(Irradiance, OfAMovingLightIsTheMeanOverTheShutter) {
  Scene scene = with_lamp();
  Matrix turn;
  turn.setAxisAngle(Vec3(0, 0, 1), 0.6f);
  const Matrix end = Matrix().scale(Vec3(0.5f, 1, 2)) * turn * Matrix().translate(Vec3(0.5f, 1, 0));
  scene.tracks.push_back({{0, 1}, {Matrix(), end}});
  scene.objects.push_back({.track = 0});
  add_mesh(scene, grid(kRectangle.corner, kRectangle.edge_u, kRectangle.edge_v, 2, 0));
  scene.instances[0].object = 0;
  scene.quads.push_back({{-3, 3, -1}, {0.5f, 0, 0}, {0, 0, 0.5f}});  // a second light, which rests
  const Geometry geometry(scene, {0, 1});
  double known = 0;
  constexpr int kTimes = 400;
  for (int i = 0; i < kTimes; ++i) {
    const Matrix m = geometry.to_world(0, (float(i) + 0.5f) / kTimes);
    std::vector<V3d> corners;
    for (const Vec3& p :
         {kRectangle.corner, kRectangle.corner + kRectangle.edge_u,
          kRectangle.corner + kRectangle.edge_u + kRectangle.edge_v, kRectangle.corner + kRectangle.edge_v})
      corners.emplace_back(moved(p, m));
    known += polygon(corners, {0, 1, 0}) / kTimes;
  }
  expect_all(scene, {0, 1, 0}, known + polygon(scene.quads[0], {0, 1, 0}), "moving", kAt, 1e-4);
}

}  // namespace
}  // namespace tessera::tracer
