// SPDX-License-Identifier: Apache-2.0
#include "core/quality/hdr_flip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/core/quality/pictures.h"

namespace tessera {
namespace {

double aces(double x) { return (0.9036 * x * x + 0.018 * x) / (0.8748 * x * x + 0.354 * x + 0.14); }

TEST(HdrFlip, ToneMapIsTheFitOfAces) {
  for (const float v : {0.0f, 0.01f, 0.5f, 2.0f}) EXPECT_NEAR(tone_mapped(v), aces(v), 1e-6);
  EXPECT_EQ(tone_mapped(-1.0f), 0);
  EXPECT_EQ(tone_mapped(100.0f), 1);
  EXPECT_EQ(tone_mapped(std::numeric_limits<float>::max()), 1);
}

// 99 pixels of 0.25 and one of 64: the tone-mapped 0.85 is reached by the light w.
TEST(HdrFlip, ExposuresReachFromTheBrightestToTheMedian) {
  Image r({0, 0, 10, 10}, 3, 0.25f);
  for (int c = 0; c < 3; ++c) r.at(c, 4, 4) = 64;
  const Exposures e = flip_exposures(r);
  const double w = std::exp2(e.stop) * 0.25;
  EXPECT_NEAR(aces(w), 0.85, 1e-6);
  EXPECT_NEAR(std::exp2(e.start) * 64, w, 1e-4 * w);
  EXPECT_NEAR(e.stop - e.start, 8, 1e-5);
  EXPECT_TRUE(e.count == 8 || e.count == 9) << "8 stops, but for rounding";
  EXPECT_EQ(e.at(0), e.start);
  EXPECT_NEAR(e.at(e.count - 1), e.stop, 1e-12);
}

TEST(HdrFlip, BlackPixelsHaveNoSayInTheMedianAndConstantsTakeTwoExposures) {
  Image r({0, 0, 10, 10}, 3, 0.0f);
  EXPECT_EQ(flip_exposures(r), (Exposures{0, 0, 2}));
  r.at(0, 1, 1) = r.at(1, 1, 1) = r.at(2, 1, 1) = 4.0f;
  const Exposures one = flip_exposures(r);
  EXPECT_EQ(one.count, 2);
  EXPECT_EQ(one.start, one.stop);
  r.at(0, 2, 2) = std::nanf("");
  r.at(1, 3, 3) = std::numeric_limits<float>::infinity();
  EXPECT_EQ(flip_exposures(r), one);
}

TEST(HdrFlip, IsTheLargestFlipOfTheExposures) {
  const Region frame{0, 0, 40, 30};
  Image r = noise(frame, 6, 0.0f, 2.0f);
  for (float& v : r.data()) v = std::pow(v, 12.0f);
  Image x = r;
  for (int c = 0; c < 3; ++c)
    for (int y = 10; y < 20; ++y) x.at(c, 15, y) += 20.0f;
  const FlipKernels k = flip_kernels(kPixelsPerDegree);
  const Exposures e = flip_exposures(r);
  ASSERT_GT(e.count, 3);
  std::vector<double> worst(r.plane(0).size());
  for (int i = 0; i < e.count; ++i) {
    Image a = x, b = r;
    for (Image* image : {&a, &b})
      for (float& v : image->data()) v = std::min(float(aces(v * std::exp2(e.at(i)))), 1.0f);
    const ErrorMap one = flip_map(a, b, k);
    for (std::size_t p = 0; p < worst.size(); ++p) worst[p] = std::max(worst[p], one.values[p]);
  }
  const ErrorMap map = hdr_flip_map(x, r, k, e);
  for (std::size_t p = 0; p < worst.size(); ++p) EXPECT_NEAR(map.values[p], worst[p], 1e-3);
  EXPECT_EQ(largest(hdr_flip_map(r, r, k, e)), 0);
  EXPECT_GT(largest(map), 0.1);
}

// An error in the highlights, that no single exposure for the median shows.
TEST(HdrFlip, SeesWhatIsBurntOutOnTheDisplay) {
  Image r({0, 0, 40, 30}, 3, 0.5f);
  for (int c = 0; c < 3; ++c)
    for (int y = 10; y < 20; ++y)
      for (int x = 10; x < 20; ++x) r.at(c, x, y) = 50;
  Image x = r;
  for (int c = 0; c < 3; ++c)
    for (int y = 12; y < 18; ++y)
      for (int px = 12; px < 18; ++px) x.at(c, px, y) = 25;
  const FlipKernels k = flip_kernels(kPixelsPerDegree);
  EXPECT_EQ(largest(flip_map(x, r, k)), 0);
  EXPECT_GT(largest(hdr_flip_map(x, r, k, flip_exposures(r))), 0.2);
}

TEST(HdrFlip, NanIsNotHidden) {
  const Image r = noise({0, 0, 30, 30}, 7);
  Image x = r;
  x.at(0, 20, 20) = std::nanf("");
  EXPECT_TRUE(std::isnan(mean(hdr_flip_map(x, r, flip_kernels(kPixelsPerDegree), flip_exposures(r)))));
}

}  // namespace
}  // namespace tessera
