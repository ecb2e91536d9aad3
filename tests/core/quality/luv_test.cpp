// SPDX-License-Identifier: Apache-2.0
#include "core/quality/luv.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/quality/color_space.h"
#include "tests/core/quality/pictures.h"

namespace tessera {
namespace {

const Region kFrame{0, 0, 3, 2};
constexpr Matrix3 kXyz = xyz_of_rgb(), kRgb = rgb_of_xyz();

Triple luv_of(float r, float g, float b) { return luv(kXyz * Triple{r, g, b}); }

TEST(ColorSpace, GreysHaveThreeEqualValuesAndComeBack) {
  for (const float v : {0.0f, 0.001f, 0.18f, 1.0f}) {
    for (const float c : kXyz* Triple{v, v, v}) EXPECT_NEAR(c, v, 1e-6f);
    const Triple back = kRgb * (kXyz * Triple{v, 0.5f, 1 - v});
    EXPECT_NEAR(back[0], v, 2e-6f);
    EXPECT_NEAR(back[1], 0.5f, 2e-6f);
    EXPECT_NEAR(back[2], 1 - v, 2e-6f);
  }
}

TEST(ColorSpace, LightnessIsThatOfCie1976) {
  EXPECT_NEAR(luv_of(1, 1, 1)[0], 100, 1e-4f);
  EXPECT_NEAR(luv_of(0.18f, 0.18f, 0.18f)[0], 49.496f, 1e-3f);
  EXPECT_NEAR(luv_of(0.001f, 0.001f, 0.001f)[0], std::pow(29.0 / 3.0, 3) * 0.001, 1e-4);
  EXPECT_NEAR(luv_of(0, 0, 0)[0], 0, 1e-6f);
}

TEST(ColorSpace, GreysHaveNoChroma) {
  for (const float v : {0.0f, 0.18f, 1.0f}) {
    EXPECT_NEAR(luv_of(v, v, v)[1], 0, 1e-3f);
    EXPECT_NEAR(luv_of(v, v, v)[2], 0, 1e-3f);
  }
}

// Red of sRGB has x 0.64, y 0.33 and Y 0.2126, white x 0.3127, y 0.3290; u' = 4x / (-2x + 12y + 3).
TEST(ColorSpace, RedIsWhereItsChromaticityPutsIt) {
  const double lightness = 116 * std::cbrt(0.2126) - 16;
  const double u = 4 * 0.64 / (-2 * 0.64 + 12 * 0.33 + 3), v = 9 * 0.33 / (-2 * 0.64 + 12 * 0.33 + 3);
  const double un = 4 * 0.3127 / (-2 * 0.3127 + 12 * 0.329 + 3),
               vn = 9 * 0.329 / (-2 * 0.3127 + 12 * 0.329 + 3);
  const Triple red = luv_of(1, 0, 0);
  EXPECT_NEAR(red[0], lightness, 0.01);
  EXPECT_NEAR(red[1], 13 * lightness * (u - un), 0.05);
  EXPECT_NEAR(red[2], 13 * lightness * (v - vn), 0.05);
}

TEST(Luv, GreysDifferInLightnessAlone) {
  const Image a = constant(kFrame, 1, 1, 1), b = constant(kFrame, 0.18f, 0.18f, 0.18f);
  const double expected = (100 - 49.496) * (100 - 49.496);
  EXPECT_NEAR(mean(lightness_error_map(a, b)), expected, 0.1);
  EXPECT_NEAR(mean(luv_error_map(a, b)), expected, 0.1);
}

TEST(Luv, IsSquaredDistanceOfColours) {
  const Image red = constant(kFrame, 1, 0, 0), blue = constant(kFrame, 0, 0, 1);
  const Triple p = luv_of(1, 0, 0), q = luv_of(0, 0, 1);
  double distance = 0;
  for (int k = 0; k < 3; ++k) distance += (double{p[k]} - q[k]) * (double{p[k]} - q[k]);
  EXPECT_DOUBLE_EQ(mean(luv_error_map(red, blue)), distance);
  EXPECT_LT(mean(lightness_error_map(red, blue)), 0.1 * distance);
  EXPECT_EQ(mean(luv_error_map(red, red)), 0);
}

TEST(Luv, NanIsNotHidden) {
  const Image r = constant(kFrame, 0.5f, 0.5f, 0.5f);
  Image x = r;
  x.at(2, 1, 1) = std::nanf("");
  EXPECT_TRUE(std::isnan(mean(luv_error_map(x, r))) && std::isnan(mean(lightness_error_map(x, r))));
}

}  // namespace
}  // namespace tessera
