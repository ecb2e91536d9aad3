// SPDX-License-Identifier: Apache-2.0
// Poses on a track, where they are known.
#include "core/scene/track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace tessera {
namespace {

constexpr double kPi = std::numbers::pi;

Matrix turn(const Vec3& axis, double angle) {
  Matrix m;
  m.setAxisAngle(axis, static_cast<float>(angle));
  return m;
}
Matrix scaled(float x, float y, float z) {
  Matrix m;
  m.setScale(Vec3(x, y, z));
  return m;
}
Matrix moved(float x, float y, float z) {
  Matrix m;
  m.setTranslation(Vec3(x, y, z));
  return m;
}

void expect_near(const Matrix& a, const Matrix& b, const char* what, float slack = 2e-6f) {
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(a[i][k], b[i][k], slack) << what << ", " << i << " " << k;
}

TEST(Track, StandsStillBeforeTheFirstKeyAndAfterTheLastAndAtAKeyIsTheKey) {
  const Matrix a = scaled(1.1f, 2, 3) * turn({0, 1, 0}, 0.3) * moved(1, 2, 3), b = moved(5, 0, 0),
               c = scaled(0, 0, 0);
  const Track track{{1, 2, 4}, {a, b, c}};
  const Movement movement(track);
  for (const auto& [time, key] : {std::pair{-7.0, a}, {1.0, a}, {2.0, b}, {4.0, c}, {99.0, c}}) {
    EXPECT_EQ(pose(track, time), key) << time;
    EXPECT_EQ(movement.at(time), key) << time;
  }
  EXPECT_EQ(pose({{3}, {b}}, 1), b);
}

TEST(Track, BetweenTwoKeysScaleAndPlaceGoStraightAndTheRotationAlongAGreatArc) {
  const Vec3 axis = Vec3(1, 2, -0.5f).normalized();
  const Matrix a = scaled(1, 2, 3) * turn(axis, 0.2) * moved(1, 0, 0);
  const Matrix b = scaled(3, 2, 1) * turn(axis, 1.4) * moved(3, -4, 0);
  const Track track{{10, 14}, {a, b}};
  const Matrix expected = scaled(1.5f, 2, 2.5f) * turn(axis, 0.5) * moved(1.5f, -1, 0);
  expect_near(pose(track, 11), expected, "a quarter of the way");
  EXPECT_EQ(Movement(track).at(11), pose(track, 11));
}

TEST(Track, TurnsTheShorterWay) {
  const Track track{{0, 1}, {turn({0, 1, 0}, 0.25 * kPi), turn({0, 1, 0}, 1.75 * kPi)}};
  expect_near(pose(track, 0.5), turn({0, 1, 0}, 0), "over zero, not over pi");
  expect_near(pose(track, 0.25), turn({0, 1, 0}, 0.125 * kPi), "a quarter");
}

TEST(Track, AMirrorStaysAMirrorWhileItTurns) {
  const Matrix mirror = scaled(-1, 1, 1);
  const Track track{{0, 1}, {mirror * turn({0, 0, 1}, 0.1), mirror * turn({0, 0, 1}, 1.1)}};
  expect_near(pose(track, 0.5), mirror * turn({0, 0, 1}, 0.6), "half way");
}

TEST(Track, ShearIsKept) {
  Matrix shear;
  shear[1][0] = 0.5f;
  const Track still{{0, 1}, {shear, shear * moved(2, 0, 0)}};
  expect_near(pose(still, 0.5), shear * moved(1, 0, 0), "the same shear at both keys");
  // Turning with it: the polar rotation of both keys differs by the turn alone.
  const Track turning{{0, 1}, {shear, shear * turn({0, 0, 1}, 1)}};
  expect_near(pose(turning, 0.3), shear * turn({0, 0, 1}, 0.3), "turning");
}

TEST(Track, WhatShrinksToNothingDoesNotSpin) {
  const Matrix a = scaled(2, 2, 2) * turn({0, 1, 0}, 0.7);
  const Track track{{0, 1}, {a, scaled(0, 0, 0)}};
  expect_near(pose(track, 0.5), scaled(1, 1, 1) * turn({0, 1, 0}, 0.7), "half gone");
  // Flat in one direction a key still has its rotation.
  const Matrix flat = scaled(1, 0, 1);
  const Track flattened{{0, 1}, {flat * turn({0, 1, 0}, 0.2), flat * turn({0, 1, 0}, 0.6)}};
  expect_near(pose(flattened, 0.5), flat * turn({0, 1, 0}, 0.4), "flat");
}

}  // namespace
}  // namespace tessera
