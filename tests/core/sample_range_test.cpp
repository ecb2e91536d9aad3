// SPDX-License-Identifier: Apache-2.0
#include "core/sample_range.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(SampleRange, OnlyAlignedPowersOfTwoAreNodesOfTheTree) {
  EXPECT_TRUE(is_dyadic({0, 8}));
  EXPECT_TRUE(is_dyadic({48, 64}));
  EXPECT_FALSE(is_dyadic({0, 4}));   // below a leaf
  EXPECT_FALSE(is_dyadic({8, 24}));  // not aligned
  EXPECT_FALSE(is_dyadic({0, 24}));  // not a power of two
  EXPECT_FALSE(is_dyadic({-8, 0}));
}

TEST(SampleRange, ASiblingSharesTheParent) {
  EXPECT_EQ(sibling({0, 8}), (SampleRange{8, 16}));
  EXPECT_EQ(sibling({24, 32}), (SampleRange{16, 24}));
  EXPECT_TRUE(are_siblings({16, 24}, {24, 32}));
  EXPECT_FALSE(are_siblings({8, 16}, {16, 24}));  // neighbours with different parents
}

TEST(SampleRange, BlocksCoverTheRangeAndRespectTheLimitUnlessALeafForbidsIt) {
  EXPECT_EQ(dyadic_blocks({64, 128}, 32), (std::vector<SampleRange>{{64, 96}, {96, 128}}));
  EXPECT_EQ(dyadic_blocks({0, 16}, 1), (std::vector<SampleRange>{{0, 8}, {8, 16}}));
  EXPECT_EQ(dyadic_blocks({16, 32}, 1000), (std::vector<SampleRange>{{16, 32}}));
}

}  // namespace
}  // namespace tessera
