// SPDX-License-Identifier: Apache-2.0
#include "core/quality/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace tessera {
namespace {

const Region kFrame{3, -2, 40, 31};

Image noise(const Region& region, unsigned seed, float low = 0.0f, float high = 1.0f) {
  Image image(region, 3);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(low, high);
  for (float& v : image.data()) v = value(random);
  return image;
}

TEST(Metrics, AConstantOffsetGivesTheTextbookValues) {
  const Image r(kFrame, 3, 0.5f), x(kFrame, 3, 0.6f);
  EXPECT_NEAR(mse(x, r), 0.01, 1e-8);
  EXPECT_NEAR(rmse(x, r), 0.1, 1e-7);
  EXPECT_NEAR(rel_mse(x, r), 0.01 / 0.26, 1e-7);
  EXPECT_NEAR(rel_mse_trimmed(x, r), 0.01 / 0.26, 1e-7);
  const Image zero(kFrame, 3, 0.0f), one(kFrame, 3, 1.0f);
  EXPECT_NEAR(rel_mse(zero, one), 1 / 1.01, 1e-12);
  EXPECT_NEAR(rel_mse(one, zero), 100, 1e-10);
  EXPECT_EQ(rel_mse(one, one), 0);
}

TEST(Metrics, OneWrongPixelIsTrimmedFromAThousandButNotFromFewer) {
  for (const int pixels : {999, 1000}) {
    const Region strip{0, 0, pixels, 1};
    const Image r(strip, 3, 0.0f);
    Image x = r;
    for (int c = 0; c < 3; ++c) x.at(c, 17, 0) = 1.0f;
    EXPECT_NEAR(rel_mse(x, r), 100.0 / pixels, 1e-9);
    EXPECT_NEAR(rel_mse_trimmed(x, r), pixels < 1000 ? 100.0 / pixels : 0.0, 1e-9);
    EXPECT_NEAR(rel_mse_map(x, r).at(0, 17, 0), 100.0f, 1e-4f);
  }
}

TEST(Metrics, ValuesThatAreNotFiniteAreNeverHidden) {
  const Image r = noise(kFrame, 1);
  Image x = r;
  x.at(1, 10, 10) = std::nanf("");
  EXPECT_TRUE(std::isnan(rel_mse(x, r)) && std::isnan(mse(x, r)) && std::isnan(ssim(x, r)));
  EXPECT_TRUE(std::isnan(rel_mse_trimmed(x, r)));
  EXPECT_TRUE(std::isnan(rel_mse_map(x, r).at(0, 10, 10)));
  x.at(1, 10, 10) = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(std::isinf(rel_mse(x, r)) && std::isinf(mse(x, r)));
  EXPECT_TRUE(std::isnan(rel_mse_trimmed(x, r)));
}

TEST(Metrics, TheDisplayCurveIsSrgb) {
  Image image({0, 0, 5, 1}, 3, 0.0f);
  const float in[] = {-1.0f, 0.0031308f, 0.5f, 1.0f, 9.0f};
  std::ranges::copy(in, image.plane(2).begin());
  const Image out = displayed(image);
  EXPECT_EQ(out.at(2, 0, 0), 0.0f);
  EXPECT_NEAR(out.at(2, 1, 0), 0.04045f, 1e-5f);
  EXPECT_NEAR(out.at(2, 2, 0), 0.735357f, 1e-5f);
  EXPECT_NEAR(out.at(2, 3, 0), 1.0f, 1e-6f);
  EXPECT_NEAR(out.at(2, 4, 0), 1.0f, 1e-6f);
  EXPECT_NEAR(displayed(image, -1.0f).at(2, 3, 0), 0.735357f, 1e-5f);
}

float linear(float display) { return std::pow((display + 0.055f) / 1.055f, 2.4f); }

TEST(Ssim, KnowsConstantImagesAndItself) {
  const Image a(kFrame, 3, linear(0.5f)), b(kFrame, 3, linear(0.6f));
  EXPECT_NEAR(ssim(a, b), (2 * 0.3 + 1e-4) / (0.25 + 0.36 + 1e-4), 1e-5);
  EXPECT_NEAR(ssim(b, a), ssim(a, b), 1e-12);
  const Image n = noise(kFrame, 2);
  EXPECT_NEAR(ssim(n, n), 1.0, 1e-9);
}

// Straight from the definition, without separable sums.
double slow_ssim(const Image& x, const Image& r) {
  const Image a = displayed(x), b = displayed(r);
  const Region area = x.region();
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

// Adds `step` to every second tile, as a filter that treats tiles apart would.
Image with_seams(Image image, Size tile, float step) {
  const Region r = image.region();
  for (int c = 0; c < 3; ++c)
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x)
        if ((((x + 1024 * tile.width) / tile.width) + ((y + 1024 * tile.height) / tile.height)) % 2)
          image.at(c, x, y) += step;
  return image;
}

TEST(Seam, IsAboutOneForNoiseAndGrowsWithAStepAtTheBorders) {
  const Region frame{-30, 7, 300, 250};
  const Image r = noise(frame, 5, 0.0f, 3.0f);
  Image x = r;
  const Image n = noise(frame, 6, -0.05f, 0.05f);
  for (std::size_t i = 0; i < x.data().size(); ++i) x.data()[i] += n.data()[i];
  const Size tile{37, 53};
  // Jumps of independent uniform noise have a coefficient of variation of 0.71; the mean over N triples of
  // channels has 0.71 / sqrt(3 N) at most (neighbouring jumps are apart), with N above 3000 here.
  EXPECT_NEAR(seam(x, r, tile), 1.0, 5 * 0.71 * std::sqrt(2.0 / (3 * 3000)));
  EXPECT_GT(seam(with_seams(x, tile, 0.1f), r, tile), 2.0);
  EXPECT_NEAR(seam(with_seams(x, tile, 0.1f), r, {38, 51}), 1.0, 0.2) << "not at other tiles' borders";
}

TEST(Seam, StatesTheLimits) {
  const Image r = noise(kFrame, 8);
  EXPECT_EQ(seam(r, r, {16, 16}), 1.0);
  EXPECT_TRUE(std::isnan(seam(r, r, {512, 512}))) << "a border, but no line between borders";
  const Image inside = noise({1, 1, 30, 30}, 9);
  EXPECT_TRUE(std::isnan(seam(inside, inside, {512, 512}))) << "no border";
  EXPECT_TRUE(std::isnan(seam(inside, inside, {1, 1}))) << "nothing but borders";
  const Image zero({0, 0, 64, 64}, 3, 0.0f);
  EXPECT_TRUE(std::isinf(seam(with_seams(zero, {16, 16}, 1.0f), zero, {16, 16})));
}

}  // namespace
}  // namespace tessera
