// SPDX-License-Identifier: Apache-2.0
#include "core/quality/ssim.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/quality/pictures.h"

namespace tessera {
namespace {

const Region kFrame{3, -2, 40, 31};

TEST(Ssim, KnowsConstantImagesAndItself) {
  const Image a(kFrame, 3, 0.5f), b(kFrame, 3, 0.6f);
  EXPECT_NEAR(ssim(a, b), (2 * 0.3 + 1e-4) / (0.25 + 0.36 + 1e-4), 1e-5);
  EXPECT_NEAR(ssim(b, a), ssim(a, b), 1e-12);
  const Image n = noise(kFrame, 2);
  EXPECT_NEAR(ssim(n, n), 1.0, 1e-9);
}

// Straight from the definition, without separable sums.
double slow_ssim(const Image& a, const Image& b) {
  const Region area = a.region();
  double total = 0, count = 0;
  for (int c = 0; c < 3; ++c)
    for (int y = area.y0 + 5; y < area.y1 - 5; ++y)
      for (int px = area.x0 + 5; px < area.x1 - 5; ++px) {
        double w = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
        for (int v = -5; v <= 5; ++v)
          for (int u = -5; u <= 5; ++u) {
            const double g = std::exp(-(u * u + v * v) / (2 * 1.5 * 1.5));
            const double p = a.at(c, px + u, y + v), q = b.at(c, px + u, y + v);
            w += g, ma += g * p, mb += g * q, aa += g * p * p, bb += g * q * q, ab += g * p * q;
          }
        ma /= w, mb /= w, aa = aa / w - ma * ma, bb = bb / w - mb * mb, ab = ab / w - ma * mb;
        total += (2 * ma * mb + 1e-4) * (2 * ab + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (aa + bb + 9e-4));
        ++count;
      }
  return total / count;
}

TEST(Ssim, EqualsItsDefinition) {
  const Image a = noise(kFrame, 3), b = noise(kFrame, 4);
  EXPECT_NEAR(ssim(a, b), slow_ssim(a, b), 1e-9);
  EXPECT_LT(ssim(a, b), 0.2);
}

TEST(Ssim, IsNanWithoutRoomForAWindow) {
  const Image small(Region{0, 0, 10, 40}, 3, 0.5f), just(Region{0, 0, 11, 11}, 3, 0.5f);
  EXPECT_TRUE(std::isnan(ssim(small, small)));
  EXPECT_NEAR(ssim(just, just), 1.0, 1e-9);
}

TEST(Ssim, IsNanIfAValueIsAndItsMapSaysWhere) {
  const Image r = noise(kFrame, 1);
  Image x = r;
  x.at(1, 10, 10) = std::nanf("");
  EXPECT_TRUE(std::isnan(ssim(x, r)));
  const ErrorMap map = dissimilarity_map(x, r);
  EXPECT_EQ(map.region, grown(kFrame, -5));
  const Image errors = image_of(map);
  for (int y = map.region.y0; y < map.region.y1; ++y)
    for (int c = map.region.x0; c < map.region.x1; ++c)
      EXPECT_EQ(std::isnan(errors.at(0, c, y)), std::abs(c - 10) <= 5 && std::abs(y - 10) <= 5);
}

}  // namespace
}  // namespace tessera
