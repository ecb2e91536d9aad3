// SPDX-License-Identifier: Apache-2.0
#include "core/quality/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/core/quality/pictures.h"

namespace tessera {
namespace {

const Region kFrame{3, -2, 40, 31};

TEST(Metrics, AConstantOffsetGivesTheTextbookValues) {
  const Image r(kFrame, 3, 0.5f), x(kFrame, 3, 0.6f);
  EXPECT_NEAR(mse(x, r), 0.01, 1e-8);
  EXPECT_NEAR(rmse(x, r), 0.1, 1e-7);
  EXPECT_NEAR(rel_mse(x, r), 0.01 / 0.26, 1e-7);
  EXPECT_NEAR(rel_mse_trimmed(x, r), 0.01 / 0.26, 1e-7);
  EXPECT_NEAR(mean(square_error_map(x, r)), 0.03, 3e-8) << "MSE0 is not divided by the channels";
  EXPECT_NEAR(mean(smape_map(x, r)), 0.1 / 1.11, 1e-7);
  EXPECT_NEAR(psnr(x, r), 20, 1e-5);
  EXPECT_NEAR(largest(difference_map(x, r)), 0.1, 1e-7);
  const Image zero(kFrame, 3, 0.0f), one(kFrame, 3, 1.0f);
  EXPECT_NEAR(rel_mse(zero, one), 1 / 1.01, 1e-12);
  EXPECT_NEAR(rel_mse(one, zero), 100, 1e-10);
  EXPECT_EQ(rel_mse(one, one), 0);
  EXPECT_NEAR(mean(smape_map(zero, one)), 1 / 1.01, 1e-12);
  EXPECT_NEAR(mean(smape_map(one, zero)), 1 / 1.01, 1e-12);
  EXPECT_EQ(psnr(one, one), std::numeric_limits<double>::infinity());
  EXPECT_EQ(psnr(one, zero), 0);
}

TEST(Metrics, OneWrongPixelIsTrimmedFromAThousandButNotFromFewer) {
  for (const int pixels : {999, 1000}) {
    const Region strip{0, 0, pixels, 1};
    const Image r(strip, 3, 0.0f);
    Image x = r;
    for (int c = 0; c < 3; ++c) x.at(c, 17, 0) = 1.0f;
    EXPECT_NEAR(rel_mse(x, r), 100.0 / pixels, 1e-9);
    EXPECT_NEAR(rel_mse_trimmed(x, r), pixels < 1000 ? 100.0 / pixels : 0.0, 1e-9);
    EXPECT_NEAR(rel_mse_map(x, r).values[17], 100.0, 1e-9);
  }
}

// One pixel, channels with errors of their own, worked out by hand.
TEST(Metrics, ChannelsAreSummedOrAveragedAsEachMetricSays) {
  const Region pixel{5, 6, 6, 7};
  const Image x = constant(pixel, 1.0f, 0.0f, -0.5f), r = constant(pixel, 0.5f, 0.25f, 0.5f);
  EXPECT_DOUBLE_EQ(mean(square_error_map(x, r)), 0.25 + 0.0625 + 1.0);
  EXPECT_DOUBLE_EQ(mse(x, r), 1.3125 / 3);
  EXPECT_DOUBLE_EQ(rel_mse(x, r), (0.25 / 0.26 + 0.0625 / 0.0725 + 1.0 / 0.26) / 3);
  EXPECT_DOUBLE_EQ(mean(smape_map(x, r)), (0.5 / 1.51 + 0.25 / 0.26 + 1.0 / 1.01) / 3);
  EXPECT_DOUBLE_EQ(largest(difference_map(x, r)), 1.0);
}

TEST(Metrics, TheLargestDifferenceIsExactToTheBit) {
  const Image r = noise(kFrame, 1);
  Image x = r;
  EXPECT_EQ(largest(difference_map(x, r)), 0.0);
  x.at(1, 10, 10) = std::nextafter(x.at(1, 10, 10), 2.0f);
  EXPECT_EQ(largest(difference_map(x, r)), double{x.at(1, 10, 10)} - r.at(1, 10, 10));
}

TEST(Metrics, ValuesThatAreNotFiniteAreNeverHidden) {
  const Image r = noise(kFrame, 1);
  Image x = r;
  x.at(1, 10, 10) = std::nanf("");
  EXPECT_TRUE(std::isnan(rel_mse(x, r)) && std::isnan(mse(x, r)) && std::isnan(mean(smape_map(x, r))));
  EXPECT_TRUE(std::isnan(rel_mse_trimmed(x, r)));
  EXPECT_TRUE(std::isnan(largest(difference_map(x, r))));
  x.at(1, 10, 10) = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(std::isinf(rel_mse(x, r)) && std::isinf(mse(x, r)));
  EXPECT_TRUE(std::isnan(rel_mse_trimmed(x, r)));
}

}  // namespace
}  // namespace tessera
