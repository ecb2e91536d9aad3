// SPDX-License-Identifier: Apache-2.0
#include "core/film.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace tessera {
namespace {

const Region kFrame{0, 0, 7, 5};

// A leaf of 8 samples with values that do not add up exactly in floats.
Block leaf(const Region& region, int begin, int planes) {
  Block block{{begin, begin + kLeafSamples}, Image(region, planes)};
  for (int p = 0; p < planes; ++p)
    for (int y = region.y0; y < region.y1; ++y)
      for (int x = region.x0; x < region.x1; ++x) {
        std::minstd_rand random(begin * 7919 + p * 131 + y * 17 + x + 1);
        block.sums.at(p, x, y) = 0.1f + static_cast<float>(random()) * 1e-7f;
      }
  return block;
}

Block node(const Region& region, const SampleRange& samples, const FilmLayout& layout) {
  if (samples.count() == kLeafSamples) return leaf(region, samples.begin, layout.planes());
  const int middle = samples.begin + samples.count() / 2;
  Block block = node(region, {samples.begin, middle}, layout);
  join(block, node(region, {middle, samples.end}, layout), layout);
  return block;
}

TEST(Film, HoldsTheSameBitsHoweverTheWorkWasCutAndInWhateverOrderItArrives) {
  const AovSet aovs{Aov::color, Aov::depth};
  const FilmLayout layout(aovs);
  const Block whole = node(kFrame, {0, 64}, layout);
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    std::vector<Block> blocks;
    for (const Region& piece :
         grid_cells(kFrame, {1 + static_cast<int>(random() % 7), 1 + static_cast<int>(random() % 5)}))
      for (int n = 0; n < 64; n = n == 0 ? 16 : 2 * n)
        for (const SampleRange& s : dyadic_blocks({n, n == 0 ? 16 : 2 * n}, 8 << random() % 4))
          blocks.push_back(node(piece, s, layout));
    std::shuffle(blocks.begin(), blocks.end(), random);
    Film film(kFrame, aovs);
    for (const Block& block : blocks) {
      EXPECT_TRUE(film.fold(block));
      EXPECT_FALSE(film.fold(block)) << "a block enters once; seed " << seed;
    }
    EXPECT_TRUE(film.settled());
    EXPECT_TRUE(film.covers(kFrame, 64));
    ASSERT_TRUE(same_bits(film.sums(), whole.sums)) << "seed " << seed;
  }
}

TEST(Film, ABlockThatOverlapsAPendingOneIsRefused) {
  Film film(kFrame, {Aov::color});
  const FilmLayout& layout = film.layout();
  EXPECT_TRUE(film.fold(node(kFrame, {0, 16}, layout)));
  EXPECT_TRUE(film.fold(node(kFrame, {24, 32}, layout)));
  EXPECT_FALSE(film.settled());
  EXPECT_FALSE(film.fold(node(kFrame, {16, 32}, layout)));
  EXPECT_TRUE(film.covers(kFrame, 16));
  EXPECT_TRUE(film.fold(node(kFrame, {16, 24}, layout)));
  EXPECT_TRUE(film.covers(kFrame, 32));
}

TEST(Film, DevelopsMeansVariancesAndDepth) {
  const FilmLayout layout({Aov::color, Aov::depth});
  Image sums({0, 0, 2, 1}, layout.planes());
  // Pixel 0: A has red samples 1, 2; B has red samples 3, 6, of which one hits at depth 5. Pixel 1: nothing.
  sums.at(FilmLayout::count(Half::a), 0, 0) = 2;
  sums.at(FilmLayout::count(Half::b), 0, 0) = 2;
  sums.at(FilmLayout::hits(Half::b), 0, 0) = 1;
  sums.at(layout.sum(Aov::color, 0, Half::a), 0, 0) = 3;
  sums.at(layout.square(Aov::color, 0, Half::a), 0, 0) = 5;
  sums.at(layout.sum(Aov::color, 0, Half::b), 0, 0) = 9;
  sums.at(layout.square(Aov::color, 0, Half::b), 0, 0) = 45;
  sums.at(layout.sum(Aov::depth, 0, Half::b), 0, 0) = 5;
  const std::vector<Channel> channels{
      {Aov::color, 0}, {Aov::color, 0, Statistic::variance_of_mean}, {Aov::depth, 0}};
  const auto pixel = [&](Part part, int x) {
    const Image image = developed(sums, layout, channels, part);
    return std::vector{image.at(0, x, 0), image.at(1, x, 0), image.at(2, x, 0)};
  };
  EXPECT_EQ(pixel(Part::a, 0), (std::vector{1.5f, 0.25f, kSkyDepth}));
  EXPECT_EQ(pixel(Part::b, 0), (std::vector{4.5f, 2.25f, 5.0f}));
  EXPECT_EQ(pixel(Part::all, 0), (std::vector{3.0f, (50.0f - 36.0f) / 12.0f, 5.0f}));
  EXPECT_EQ(pixel(Part::all, 1), (std::vector{0.0f, 0.0f, kSkyDepth}));
}

TEST(FilmLayout, FindsThePlanesOfAPart) {
  const FilmLayout all({Aov::color, Aov::direct, Aov::albedo, Aov::depth, Aov::guide_squares}),
      some({Aov::direct, Aov::depth});
  const std::vector<int> planes = all.planes_of(some);
  ASSERT_EQ(std::ssize(planes), some.planes());
  EXPECT_EQ(planes[FilmLayout::hits(Half::b)], FilmLayout::hits(Half::b));
  for (const Half h : {Half::a, Half::b}) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(planes[some.sum(Aov::direct, c, h)], all.sum(Aov::direct, c, h));
      EXPECT_EQ(planes[some.square(Aov::direct, c, h)], all.square(Aov::direct, c, h));
    }
    EXPECT_EQ(planes[some.sum(Aov::depth, 0, h)], all.sum(Aov::depth, 0, h));
  }
}

}  // namespace
}  // namespace tessera
