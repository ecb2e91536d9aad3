// SPDX-License-Identifier: Apache-2.0
#include "core/filter/history.h"

#include <gtest/gtest.h>

#include <limits>

namespace tessera {
namespace {

constexpr Region kFrame{0, 0, 40, 30};

Image moving(float dx, float dy) {
  Image motion(kFrame, 2, dx);
  for (float& v : motion.plane(1)) v = dy;
  return motion;
}

TEST(Footprint, OfWhatStandsStillIsItselfAndTheTapsAround) {
  EXPECT_EQ(footprint(moving(0, 0), {10, 10, 20, 15}, kFrame), (Region{9, 9, 22, 17}));
}

TEST(Footprint, FollowsTheMotionBackwards) {
  EXPECT_EQ(footprint(moving(3.5f, -2.25f), {10, 10, 20, 15}, kFrame), (Region{5, 11, 18, 19}));
}

TEST(Footprint, IsCutToTheFrame) {
  EXPECT_EQ(footprint(moving(0, 0), kFrame, kFrame), kFrame);
  EXPECT_EQ(footprint(moving(0, 0), {0, 0, 1, 1}, kFrame), (Region{0, 0, 3, 3}));
  const Region crop{8, 8, 32, 24};
  EXPECT_EQ(footprint(moving(0, 0), {8, 8, 9, 9}, crop), (Region{8, 8, 11, 11}));
}

TEST(Footprint, OfWhatComesFromOutsideIsEmpty) {
  EXPECT_TRUE(footprint(moving(50, 0), {10, 10, 20, 15}, kFrame).empty());
  EXPECT_TRUE(footprint(moving(0, -31), {10, 10, 20, 15}, kFrame).empty());
}

TEST(Touched, IsTheFootprintOrAPixelThatTellsThatThereIsAHistory) {
  const Image history(kFrame, 4, 1.0f);
  EXPECT_EQ(touched(history, moving(0, 0), {10, 10, 20, 15}, kFrame).region(), (Region{9, 9, 22, 17}));
  EXPECT_EQ(touched(history, moving(50, 0), {10, 10, 20, 15}, kFrame).region(), (Region{0, 0, 1, 1}));
  EXPECT_TRUE(touched({}, moving(0, 0), {10, 10, 20, 15}, kFrame).empty());
}

TEST(Footprint, HoldsBothEndsOfAnObjectThatMovesOverAStillGround) {
  Image motion = moving(0, 0);
  motion.at(0, 12, 12) = -15.5f;  // came from (27.5, 12)
  EXPECT_EQ(footprint(motion, {10, 10, 20, 15}, kFrame), (Region{9, 9, 30, 17}));
}

TEST(Footprint, MotionThatIsNoNumberLeadsNowhere) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity(), 3e38f}) {
    Image motion = moving(0, 0);
    motion.at(0, 12, 12) = bad;
    EXPECT_EQ(footprint(motion, {12, 12, 14, 13}, kFrame), (Region{12, 11, 16, 15})) << bad;
    EXPECT_TRUE(footprint(motion, {12, 12, 13, 13}, kFrame).empty()) << bad;
  }
}

}  // namespace
}  // namespace tessera
