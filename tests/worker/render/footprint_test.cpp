// SPDX-License-Identifier: Apache-2.0
// Ray cones on surfaces: known answers.
#include "worker/render/footprint.h"

#include <gtest/gtest.h>

#include "tests/worker/render/scenes.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;

TEST(Footprint, OfAQuadSeenHeadOnIsTheConesWidthOverItsEdge) {
  for (const float edge : {1.0f, 4.0f}) {
    Scene scene;
    add_material(scene, {});
    add_mesh(scene, grid({0, 0, 0}, {edge, 0, 0}, {0, edge, 0}, 3, 0));
    const Geometry geometry(scene);
    for (std::uint32_t t = 0; t < 18; ++t)
      EXPECT_NEAR(uv_per_metre(geometry, {0, t, 0.3f, 0.3f}), 1 / edge, 1e-5f);
    EXPECT_FLOAT_EQ(uv_per_metre(Quad{{0, 0, 0}, {edge, 0, 0}, {0, edge, 0}}), 1 / edge);
    // A cone that spreads by 0.01 radians, after 5 metres.
    EXPECT_FLOAT_EQ(uv_width(0.01f * 5, 1, 1 / edge), 0.05f / edge);
  }
}

TEST(Footprint, FollowsWhatAnInstanceIsScaledBy) {
  Scene scene;
  add_material(scene, {});
  add_mesh(scene, grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1, 0), Matrix().scale(Vec3(2, 8, 1)));
  EXPECT_NEAR(uv_per_metre(Geometry(scene), {0, 1, 0.2f, 0.2f}), 0.25f, 1e-6f) << "the root of 1 / 16";
}

TEST(Footprint, OfASphereIsThePictureOverItsSurface) {
  Scene scene;
  scene.spheres = {{{0, 0, 0}, 1}, {{0, 0, 0}, 10}};
  const Geometry geometry(scene);
  const std::uint32_t piece = 0;  // there are no meshes
  EXPECT_NEAR(uv_per_metre(geometry, {piece, 0, 0, 0}), 1 / std::sqrt(4 * kPi), 1e-6f);
  EXPECT_NEAR(uv_per_metre(geometry, {piece, 1, 0, 0}), 0.1f / std::sqrt(4 * kPi), 1e-7f);
}

TEST(Footprint, HasTheAreaOfTheEllipseThatASlantedConeCovers) {
  // At 60 degrees the ellipse is as wide as the cone and twice as long.
  EXPECT_NEAR(square(uv_width(0.1f, 0.5f, 1)), 0.1f * 0.2f, 1e-6f);
  EXPECT_FLOAT_EQ(uv_width(0.1f, -0.5f, 1), uv_width(0.1f, 0.5f, 1)) << "from behind";
  EXPECT_TRUE(std::isfinite(uv_width(0.1f, 0, 1)));
}

TEST(Footprint, IsNothingWhereThereIsNoAreaOrNoTexture) {
  Scene scene;
  add_material(scene, {});
  add_mesh(scene, {.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}});
  add_mesh(scene, {.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}},
                   .uvs = {{0, 0}, {1, 0}, {0, 1}},
                   .triangles = {{0, 1, 2}}});
  EXPECT_EQ(uv_per_metre(Geometry(scene), {0, 0, 0.3f, 0.3f}), 0);
  EXPECT_EQ(uv_per_metre(Geometry(scene), {1, 0, 0.3f, 0.3f}), 0);
}

}  // namespace
}  // namespace tessera::tracer
