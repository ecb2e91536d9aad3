// SPDX-License-Identifier: Apache-2.0
#include "core/quality/seam.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/quality/pictures.h"

namespace tessera {
namespace {

const Region kFrame{3, -2, 40, 31};

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
