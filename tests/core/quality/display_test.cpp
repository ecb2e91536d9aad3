// SPDX-License-Identifier: Apache-2.0
#include "core/quality/display.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/scene/srgb.h"
#include "tests/core/quality/pictures.h"

namespace tessera {
namespace {

TEST(Display, IsTheSrgbCurve) {
  Image image({0, 0, 5, 1}, 3, 0.0f);
  const float in[] = {-1.0f, 0.0031308f, 0.5f, 1.0f, 9.0f};
  std::ranges::copy(in, image.plane(2).begin());
  const Image out = displayed(image);
  EXPECT_EQ(out.at(2, 0, 0), 0.0f);
  EXPECT_NEAR(out.at(2, 1, 0), 0.04045f, 1e-5f);
  EXPECT_NEAR(out.at(2, 2, 0), 0.735357f, 1e-5f);
  EXPECT_NEAR(out.at(2, 3, 0), 1.0f, 1e-6f);
  EXPECT_NEAR(out.at(2, 4, 0), 1.0f, 1e-6f);
  EXPECT_NEAR(displayed(image, {.exposure = -1}).at(2, 3, 0), 0.735357f, 1e-5f);
}

TEST(Display, OrThePower) {
  const Image image = constant({0, 0, 1, 1}, 0.5f, -1.0f, 7.0f);
  const Image out = displayed(image, {Curve::gamma, -1.0f});
  EXPECT_NEAR(out.at(0, 0, 0), std::pow(0.25, 1 / 2.2), 1e-6);
  EXPECT_EQ(out.at(1, 0, 0), 0.0f);
  EXPECT_EQ(out.at(2, 0, 0), 1.0f);
}

TEST(Display, AScreenUndoesTheSrgbCurveAndNoOther) {
  const Image image = noise({0, 0, 9, 9}, 1, -0.2f, 1.5f);
  const Image light = screen_light(image, {.exposure = 0.5f});
  const Image gamma = screen_light(image, {Curve::gamma, 0.5f}),
              coded = displayed(image, {Curve::gamma, 0.5f});
  for (std::size_t i = 0; i < image.data().size(); ++i) {
    EXPECT_EQ(light.data()[i], std::clamp(image.data()[i] * std::sqrt(2.0f), 0.0f, 1.0f));
    EXPECT_NEAR(gamma.data()[i], from_srgb(coded.data()[i]), 1e-6f);
  }
}

TEST(Display, NanStaysAndInfinityIsWhite) {
  const Image image = constant({0, 0, 1, 1}, std::nanf(""), std::numeric_limits<float>::infinity(), 0.0f);
  for (const Curve curve : {Curve::srgb, Curve::gamma})
    for (const Image& out : {displayed(image, {curve, 1}), screen_light(image, {curve, 1})}) {
      EXPECT_TRUE(std::isnan(out.at(0, 0, 0)));
      EXPECT_NEAR(out.at(1, 0, 0), 1.0f, 1e-6f);
    }
}

}  // namespace
}  // namespace tessera
