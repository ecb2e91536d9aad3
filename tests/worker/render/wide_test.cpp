// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/worker/render/chi_squared.h"
#include "worker/render/camera.h"
#include "worker/render/geometry.h"
#include "worker/render/warp.h"
#include "worker/render/wide_warp.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;

constexpr int kPackets = 200;

// Sixteen numbers in [0, 1)^2, corners and middle of the square among them.
struct Numbers {
  explicit Numbers(Random& random) {
    for (int i = 0; i < kLanes; ++i) {
      const Vec2 u = i == 0   ? Vec2(0, 0)
                     : i == 1 ? Vec2(0.5f, 0.5f)
                     : i == 2 ? Vec2(0x1.fffffep-1f, 0)
                              : random.pair();
      wide.x[i] = u.x;
      wide.y[i] = u.y;
    }
  }
  Vec2 at(int i) const { return {wide.x[i], wide.y[i]}; }
  Wide2 wide;
};

Vec3 on_sphere(const Vec2& u) { return unit(cone(u, 2)); }

void expect_near(const Vec3& a, const Vec3& b, float most) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], most);
}

TEST(Wide, WarpsEveryLaneAsOneByOne) {
  Random random(3);
  for (int i = 0; i < kPackets; ++i) {
    const Numbers u(random);
    const Wide2 d = disc(u.wide);
    const Wide3 h = cosine_hemisphere(u.wide), c = cone(u.wide, 0.3f);
    const Wide p = power_heuristic(u.wide.x, u.wide.y);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Vec2 one = disc(u.at(lane));
      expect_near({d.x[lane], d.y[lane], 0}, {one.x, one.y, 0}, 1e-6f);
      expect_near(h.at(lane), cosine_hemisphere(u.at(lane)), 1e-3f);  // the root of what cancels at the rim
      expect_near(c.at(lane), cone(u.at(lane), 0.3f), 1e-6f);
      EXPECT_NEAR(p[lane], power_heuristic(u.at(lane).x, u.at(lane).y), 1e-6f);
    }
  }
}

TEST(Wide, MakesFramesAsOneByOne) {
  Random random(5);
  for (int i = 0; i < kPackets; ++i) {
    Wide3 normal;
    const Numbers u(random);
    for (int lane = 0; lane < kLanes; ++lane) normal.set(lane, on_sphere(u.at(lane)));
    normal.set(3, {0, 0, 1});
    normal.set(4, {0, 0, -1});
    const WideFrame frames(normal);
    const Wide3 v = cosine_hemisphere(u.wide), world = frames.to_world(v);
    for (int lane = 0; lane < kLanes; ++lane)
      expect_near(world.at(lane), Frame(normal.at(lane)).to_world(v.at(lane)), 1e-6f);
  }
}

TEST(Wide, SendsCameraRaysAsOneByOne) {
  Camera camera;
  camera.to_world = Matrix().rotate(Vec3(0.3f, 2, 0.1f)) * Matrix().translate(Vec3(1, 2, 3));
  camera.horizontal_fov = 1.2f;
  const CameraRays rays({}, camera, {64, 32}, 0, 0);
  ASSERT_TRUE(rays.pinhole());
  Random random(9);
  for (int i = 0; i < kPackets; ++i) {
    const Numbers u(random);
    const WideRay all = rays.pinhole_rays({u.wide.x * 64.0f, u.wide.y * 32.0f});
    for (int lane = 0; lane < kLanes; ++lane) {
      const Ray one = rays.ray(u.at(lane).x * 64, u.at(lane).y * 32, {0, 0}, 0);
      EXPECT_EQ(all.origin.at(lane), one.origin);
      expect_near(all.direction.at(lane), one.direction, 1e-6f);
    }
  }
}

TEST(Wide, HasNoPinholeWhereRaysDifferByMore) {
  Camera lens, sphere;
  lens.lens_radius = 0.1f;
  sphere.projection = Camera::Projection::panorama;
  EXPECT_FALSE(CameraRays({}, lens, {64, 32}, 0, 0).pinhole());
  EXPECT_FALSE(CameraRays({}, sphere, {64, 32}, 0, 0).pinhole());
}

TEST(Wide, MovesOriginsOffSurfacesAsOneByOne) {
  Random random(7);
  for (int i = 0; i < kPackets; ++i) {
    Wide3 at, normal;
    const Numbers u(random);
    for (int lane = 0; lane < kLanes; ++lane) {
      const float scale = std::exp2(random.pair().x * 24 - 12);  // both sides of where steps become absolute
      at.set(lane, on_sphere(random.pair()) * scale);
      normal.set(lane, on_sphere(u.at(lane)));
    }
    const Wide3 moved = offset_origin(at, normal);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Vec3 one = offset_origin(at.at(lane), normal.at(lane));
      for (int k = 0; k < 3; ++k) EXPECT_FLOAT_EQ(moved.at(lane)[k], one[k]);
    }
  }
}

TEST(Wide, CallsForTheLanesOfAMaskInTheirOrder) {
  Mask m{};
  EXPECT_FALSE(any(m));
  m[0] = m[7] = m[15] = -1;
  EXPECT_TRUE(any(m));
  EXPECT_EQ(bits(m), 0x8081u);
  std::vector<int> called;
  each_lane(m, [&](int lane) { called.push_back(lane); });
  EXPECT_EQ(called, (std::vector<int>{0, 7, 15}));
}

TEST(Wide, RootsOfWhatIsNegativeAreZero) {
  Wide x{};
  x[1] = -4;
  x[2] = 9;
  const Wide r = root(x);
  EXPECT_EQ(r[0], 0);
  EXPECT_EQ(r[1], 0);
  EXPECT_EQ(r[2], 3);
}

}  // namespace
}  // namespace tessera::tracer
