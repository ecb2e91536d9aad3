// SPDX-License-Identifier: Apache-2.0
// What moves while the shutter is open.
#include <gtest/gtest.h>

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/one_ray.h"
#include "tests/worker/render/scenes.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;
using tessera::testing::kPi;

// A unit square about the origin, front to +Z, on a track.
Scene moving_square(Track track, const Matrix& to_world = Matrix()) {
  Scene scene;
  add_material(scene, {});
  add_mesh(scene, grid({-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}, 1, 0), to_world);
  scene.objects.push_back({.name = "square", .track = 0});
  scene.instances[0].object = 0;
  scene.tracks.push_back(std::move(track));
  return scene;
}

Matrix turned_about_y(double angle) {
  Matrix m;
  m.setAxisAngle(Vec3(0, 1, 0), static_cast<float>(angle));
  return m;
}

RenderScene ready(Scene scene, Shutter shutter) {
  return RenderScene(std::make_shared<const Scene>(std::move(scene)), shutter);
}

TEST(Motion, ASquareThatPassesCoversAPointForTheTimeThatItTakes) {
  const Track track{{1, 2}, {Matrix().translate(Vec3(0, 0, 0)), Matrix().translate(Vec3(3, 0, 0))}};
  const RenderScene scene = ready(moving_square(track), {1, 2});
  constexpr int kTimes = 1000;
  for (const float x : {-0.4f, 0.1f, 1.3f, 2.9f, 3.3f}) {
    int covered = 0;
    for (int i = 0; i < kTimes; ++i)
      covered += look(scene, {x, 0.2f, 5}, {0, 0, -1}, {.time = (float(i) + 0.5f) / kTimes}).has_value();
    // |x - 3 t| < 1/2, t in [0, 1]
    const double from = std::clamp((x - 0.5) / 3, 0.0, 1.0), to = std::clamp((x + 0.5) / 3, 0.0, 1.0);
    EXPECT_NEAR(double(covered) / kTimes, to - from, 1.5 / kTimes) << x;
  }
}

TEST(Motion, WhatTurnsCoversAsMuchAsManyStillOnes) {
  const Track track{{0, 1, 3}, {turned_about_y(0), turned_about_y(1.4), turned_about_y(2.2)}};
  const Matrix away = Matrix().translate(Vec3(0.7f, 0, 0));
  const Shutter shutter{0.5, 2.5};
  const RenderScene scene = ready(moving_square(track, away), shutter);
  EXPECT_GT(scene.geometry().steps(0), 8u);
  Random random(3);
  int differ = 0, covered = 0;
  constexpr int kRays = 20000;
  for (int i = 0; i < kRays; ++i) {
    const float time = random.number();
    const Vec3 from(3 * random.number() - 1.5f, random.number() - 0.5f, 5);
    const auto seen = look(scene, from, {0, 0, -1}, {.time = time});
    // The square at rest, seen from where it turns to.
    const Matrix m = away * pose(track, shutter.open + (shutter.close - shutter.open) * time);
    Vec3 start = from, way(0, 0, -1);
    m.inverse().multVecMatrix(start, start);
    m.inverse().multDirMatrix(way, way);
    const Vec3 at = start + way * (-start.z / way.z);
    const bool there = std::abs(at.x) < 0.5f && std::abs(at.y) < 0.5f && -start.z / way.z > 0;
    covered += there;
    differ += there != seen.has_value();
  }
  EXPECT_GT(covered, kRays / 16);
  EXPECT_LT(differ, covered / 50);  // the steps are within a thousandth of the true movement
}

TEST(Motion, SurfacesLieWhereTheirHitsAre) {
  const Matrix end =
      Matrix().scale(Vec3(1.5f, 0.8f, 1)) * turned_about_y(2) * Matrix().translate(Vec3(0.3f, 0.1f, -1));
  const RenderScene scene = ready(moving_square({{0, 1}, {Matrix(), end}}), {0, 1});
  Random random(4);
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 from(random.number() - 0.5f, random.number() - 0.5f, 4);
    const Vec3 way = unit(Vec3(0.2f * random.number(), 0.1f, -1));
    const float time = random.number();
    const auto seen = look(scene, from, way, {.time = time});
    if (!seen) continue;
    ++hits;
    EXPECT_LT(length(from + way * seen->distance - seen->surface.position), 1e-5f);
    EXPECT_EQ(seen->surface.time, time);
    const Triangle t = scene.geometry().triangle(0, seen->hit.primitive, time);
    EXPECT_NEAR(dot(unit(t.normal), unit(cross(t.p[1] - t.p[0], t.p[2] - t.p[0]))), 1, 1e-5f);
    EXPECT_NEAR(length(t.normal), length(cross(t.p[1] - t.p[0], t.p[2] - t.p[0])), 1e-5f);
  }
  EXPECT_GT(hits, 100);
}

// Coplanar sheets among moving ones, some there once and some often: which of them a ray hits is no accident.
TEST(Motion, TheSameSceneBuiltAgainGivesTheSameHits) {
  Scene scene = moving_square({{0, 1}, {Matrix(), turned_about_y(0.4)}});
  scene.objects.emplace_back();
  for (int i = 0; i < 120; ++i)
    scene.instances.push_back(
        {0, Matrix().translate(Vec3(0.05f * float(i % 7), 0.03f * float(i % 5), 0)), i % 2});
  const auto shared = std::make_shared<const Scene>(scene);
  const RenderScene once(shared, {0, 1}), again(shared, {0, 1});
  Random random(8);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 from(1.5f * random.number() - 0.6f, random.number() - 0.5f, 2);
    const RayTraits traits{.time = i % 3 == 0 ? 0.0f : random.number()};
    const auto a = look(once, from, {0, 0, -1}, traits), b = look(again, from, {0, 0, -1}, traits);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) continue;
    ++hits;
    ASSERT_EQ(a->hit.piece, b->hit.piece);
    ASSERT_EQ(a->distance, b->distance);
    ASSERT_EQ(a->surface.position, b->surface.position);
  }
  EXPECT_GT(hits, 1000);
}

TEST(Motion, RaysSideBySideAreEachOfTheirOwnTime) {
  Scene scene = moving_square({{0, 1}, {Matrix(), turned_about_y(1) * Matrix().translate(Vec3(2, 0, 0))}});
  scene.objects.push_back({.camera = false});
  scene.quads.push_back({{-1, -1, 1}, {1.5f, 0, 0}, {0, 2, 0}, 0, 1});
  const RenderScene both = ready(scene, {0, 1});
  Random random(9);
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    Packet coherent;
    std::array<RayTraits, kLanes> traits;
    std::array<Vec3, kLanes> from;
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto l = static_cast<std::size_t>(lane);
      traits[l] = {random.number(), lane % 3 == 0 ? RayKind::scattered : RayKind::camera};
      from[l] = Vec3(2 * random.number() - 0.5f, random.number() - 0.5f, 4);
      coherent.set(lane, from[l], {0, 0, -1}, kEndless, traits[l]);
    }
    both.bvh().intersect_coherent(coherent);
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto alone = look(both, from[std::size_t(lane)], {0, 0, -1}, traits[std::size_t(lane)]);
      ASSERT_EQ(coherent.hit(lane), alone.has_value());
      if (!alone) continue;
      ++hits;
      ASSERT_EQ(coherent.at(lane).piece, alone->hit.piece);
      ASSERT_NEAR(coherent.distance(lane), alone->distance, 1e-5f);
    }
  }
  EXPECT_GT(hits, 1000);
}

TEST(Motion, AClosedShutterShowsTheMomentItOpens) {
  const Track track{{0, 1}, {Matrix(), Matrix().translate(Vec3(4, 0, 0))}};
  const RenderScene scene = ready(moving_square(track), {0.5, 0.5});
  EXPECT_EQ(scene.geometry().steps(0), 1u);
  for (const float time : {0.0f, 1.0f}) {
    EXPECT_TRUE(look(scene, {2, 0, 5}, {0, 0, -1}, {.time = time}));
    EXPECT_FALSE(look(scene, {0, 0, 5}, {0, 0, -1}, {.time = time}));
  }
  // What does not move while it is open has no steps either.
  EXPECT_EQ(ready(moving_square(track), {2, 3}).geometry().steps(0), 1u);
}

TEST(Motion, AStraightWayTakesTwoSteps) {
  const Track track{{0, 1}, {Matrix(), Matrix().translate(Vec3(4, 0, 0))}};
  EXPECT_EQ(ready(moving_square(track), {0, 1}).geometry().steps(0), 2u);
}

TEST(Motion, MatricesAtAnyTimeAreThoseOfTheTrack) {
  const Track track{{0, 1}, {Matrix(), turned_about_y(1)}};
  const Matrix away = Matrix().translate(Vec3(0, 2, 1));
  const Scene scene = moving_square(track, away);
  const Geometry geometry(scene, {0, 1});
  for (const double t : {-1.0, 0.0, 0.25, 0.77, 5.0}) {
    EXPECT_TRUE(geometry.to_world_at(0, t).equalWithAbsError(away * pose(track, t), 1e-6f));
    if (t >= 0 && t <= 1) {
      EXPECT_TRUE(geometry.to_world(0, float(t)).equalWithAbsError(away * pose(track, t), 3e-3f));
    }
  }
}

}  // namespace
}  // namespace tessera::tracer
