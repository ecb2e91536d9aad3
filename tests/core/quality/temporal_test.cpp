// SPDX-License-Identifier: Apache-2.0
#include "core/quality/temporal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/quality/pictures.h"

namespace tessera {
namespace {

const Region kFrame{0, 0, 8, 4};

Image grey(float v) { return constant(kFrame, v, v, v); }

TEST(Temporal, ErrorIsTheStepFromFrameToFrame) {
  TemporalError t;
  EXPECT_FALSE(t.add(grey(0.5f), grey(0.5f)));
  const auto first = t.add(grey(0.75f), grey(0.5f));
  ASSERT_TRUE(first);
  EXPECT_NEAR(first->error, 0.25, 1e-12);
  EXPECT_EQ(first->reference_error, 0);
  EXPECT_NEAR(first->residual, 0.25, 1e-12) << "a reference that stands still";
  const auto second = t.add(grey(0.5f), grey(0.625f));
  EXPECT_NEAR(second->error, 0.25, 1e-12);
  EXPECT_NEAR(second->reference_error, 0.125, 1e-12);
  EXPECT_NEAR(second->residual, 0.375, 1e-12);
  EXPECT_NEAR(t.relative_error(), (0.5 - 0.125) / 0.125, 1e-12);
}

TEST(Temporal, WeighsChannelsByLumaAfterTheAbsoluteValue) {
  TemporalError t;
  t.add(constant(kFrame, 0, 1, 0), grey(0));
  const auto step = t.add(constant(kFrame, 0.5f, 0.5f, 0), grey(0));
  EXPECT_NEAR(step->error, 0.5 * 0.2126 + 0.5 * 0.7152, 1e-12) << "red up and green down do not cancel";
}

TEST(Temporal, APerfectSequenceHasNoResidualHoweverItMoves) {
  TemporalError t;
  for (unsigned frame = 0; frame < 4; ++frame) {
    const Image moving = noise(kFrame, frame);
    const auto step = t.add(moving, moving);
    if (!step) continue;
    EXPECT_EQ(step->residual, 0);
    EXPECT_GT(step->error, 0.1);
    EXPECT_EQ(step->error, step->reference_error);
  }
  EXPECT_EQ(t.relative_error(), 0);
}

TEST(Temporal, DeviationIsThatOfThreeValuesByHand) {
  TemporalError t;
  for (const float v : {0.25f, 0.5f, 0.75f}) t.add(grey(v), grey(0.5f));
  EXPECT_NEAR(t.deviation(), 0.25, 1e-7);  // sqrt((0.0625 + 0 + 0.0625) / 2)
  EXPECT_EQ(t.reference_deviation(), 0);
}

TEST(Temporal, OneFrameSaysNothingAndNanIsNotHidden) {
  TemporalError t;
  t.add(grey(1), grey(1));
  EXPECT_TRUE(std::isnan(t.deviation()) && std::isnan(t.relative_error()));
  Image bad = grey(1);
  bad.at(0, 3, 3) = std::nanf("");
  const auto step = t.add(bad, grey(1));
  EXPECT_TRUE(std::isnan(step->error) && std::isnan(step->residual) && std::isnan(t.deviation()));
  EXPECT_EQ(step->reference_error, 0);
}

TEST(Temporal, AReferenceThatStandsStillHasNoRelativeError) {
  TemporalError t;
  t.add(grey(0), grey(0.5f));
  t.add(grey(1), grey(0.5f));
  EXPECT_TRUE(std::isinf(t.relative_error()));
}

}  // namespace
}  // namespace tessera
