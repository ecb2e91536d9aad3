// SPDX-License-Identifier: Apache-2.0
#include "core/quality/guards.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tessera {
namespace {

constexpr double kTarget = 0.0025;
const Region kCell{64, 0, 128, 64};

// Film sums of a cell, filled sample by sample.
class Cell {
 public:
  explicit Cell(const Region& region = kCell) : layout_({Aov::color}), sums_(region, layout_.planes()) {}

  void add(int x, int y, Half h, double r, double g, double b, bool hit = true) {
    const double rgb[] = {r, g, b};
    sums_.at(FilmLayout::count(h), x, y) += 1;
    sums_.at(FilmLayout::hits(h), x, y) += hit;
    for (int c = 0; c < 3; ++c) {
      sums_.at(layout_.sum(Aov::color, c, h), x, y) += static_cast<float>(rgb[c]);
      sums_.at(layout_.square(Aov::color, c, h), x, y) += static_cast<float>(rgb[c] * rgb[c]);
    }
  }
  // Adds to one sample that is in already.
  void brighten(int x, int y, Half h, double by) {
    for (int c = 0; c < 3; ++c) {
      sums_.at(layout_.sum(Aov::color, c, h), x, y) += static_cast<float>(by);
      sums_.at(layout_.square(Aov::color, c, h), x, y) += static_cast<float>(by * by);
    }
  }
  // `samples` a pixel, half of them each in A and B; value(x, y) is called for each.
  template <typename Value>
  void fill(int samples, const Value& value, bool hit = true) {
    const Region r = sums_.region();
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x)
        for (int i = 0; i < samples; ++i) {
          const double v = value(x, y);
          add(x, y, i % 2 ? Half::b : Half::a, v, 0.5 * v, 0.25 * v, hit);
        }
  }
  Guard guard(double target = kTarget) const { return guard_of(sums_, layout_, sums_.region(), target); }

 private:
  FilmLayout layout_;
  Image sums_;
};

TEST(Guards, LetCleanGaussianCellsPass) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 0.3);
    Cell cell;
    cell.fill(16, [&](int x, int y) { return 0.2 + (x + y) % 5 + noise(random); });
    EXPECT_EQ(cell.guard(), Guard::none) << "seed " << seed;
  }
}

TEST(Guards, LetOrdinaryPathTracingNoisePass) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::exponential_distribution<double> light(1.0);
    std::bernoulli_distribution hit(0.1);
    Cell cell;
    cell.fill(16, [&](int x, int) { return hit(random) ? 10 * light(random) * (x % 16 < 8 ? 0.1 : 1) : 0; });
    EXPECT_EQ(cell.guard(), Guard::none) << "seed " << seed;
  }
}

TEST(Guards, LetQuietCellsWithANoisyObjectPass) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::exponential_distribution<double> light(1.0);
    Cell cell;  // thin glossy stripes, a twentieth of the cell, on a wall without noise
    cell.fill(32, [&](int x, int y) { return (x + 2 * y) % 20 == 0 ? 3 * light(random) : 0.5; });
    EXPECT_EQ(cell.guard(), Guard::none) << "seed " << seed;
  }
}

TEST(Guards, LetALampInTheDarkPass) {
  Cell cell;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(1.0, 0.2);
  cell.fill(16, [&](int x, int y) { return x / 4 == 20 && y / 4 == 5 ? 1000.0 : 0.05 * noise(random); });
  EXPECT_EQ(cell.guard(), Guard::none);
}

TEST(Guards, CatchASingleFireflyUntilSamplesHaveDrownedIt) {
  for (const int samples : {16, 16384}) {
    std::mt19937 random(2);
    std::normal_distribution<double> noise(0.0, 0.2);
    const Region small{64, 0, 96, 32};
    Cell cell(small);
    cell.fill(samples, [&](int, int) { return 1.0 + noise(random); });
    EXPECT_EQ(cell.guard(), Guard::none);
    cell.brighten(70, 20, Half::a, 300);
    EXPECT_EQ(cell.guard(), samples == 16 ? Guard::heavy_tails : Guard::none) << samples;
  }
}

TEST(Guards, LiftWhenFirefliesAreSoManyThatTheirRateIsKnown) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.2);
  Cell cell;
  cell.fill(16, [&](int, int) { return 1.0 + noise(random); });
  const auto flash = [&](int block) {
    cell.brighten(64 + block % 8 * 8 + block % 5, block / 8 * 8 + block % 3, block % 2 ? Half::a : Half::b,
                  100);
  };
  for (int i = 0; i < 7; ++i) flash(9 * i);
  EXPECT_EQ(cell.guard(), Guard::heavy_tails);
  for (int i = 0; i < 20; ++i) flash(3 * i + 1);
  EXPECT_EQ(cell.guard(), Guard::none);
}

TEST(Guards, CatchEnergyThatOneHalfSawInFewPixels) {
  Cell cell;
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.1, 0.01);
  cell.fill(16, [&](int, int) { return noise(random); });
  for (int i = 0; i < 40; ++i) cell.brighten(64 + i, i, Half::b, 400);
  EXPECT_EQ(cell.guard(), Guard::concentrated_energy);
  for (int i = 0; i < 40; ++i) cell.brighten(64 + i, i, Half::a, 400);
  EXPECT_NE(cell.guard(), Guard::concentrated_energy) << "both halves see a bright line";
}

TEST(Guards, CatchOneSampleThatCouldMoveTheMean) {
  Cell cell;  // the same firefly in both halves: no difference to see
  cell.fill(16, [](int, int) { return 1.0; });
  for (const Half h : {Half::a, Half::b}) cell.brighten(100, 30, h, 2000);
  EXPECT_EQ(cell.guard(1e-2), Guard::none) << "moves the mean by 2000 / 65536 = 0.03, the target allows 0.1";
  EXPECT_EQ(cell.guard(1e-4), Guard::single_sample) << "0.03, the target allows 0.01";
}

TEST(Guards, CatchBlocksWhereHardlyAnySampleCarriedLight) {
  for (const int lit : {10, 40}) {
    std::mt19937 random(5);
    Cell cell;
    cell.fill(16, [&](int x, int y) { return x < 72 && y < 8 ? 0.0 : 0.05; });
    for (int i = 0; i < lit; ++i)
      cell.add(64 + static_cast<int>(random() % 8), static_cast<int>(random() % 8), i % 2 ? Half::a : Half::b,
               0.8, 0.8, 0.8);
    EXPECT_EQ(cell.guard(), lit == 10 ? Guard::too_dark : Guard::none) << lit;
  }
}

TEST(Guards, BelieveBlacknessOfEmptinessAtOnceAndOfObjectsLater) {
  const auto black_beside_lit = [](int samples, bool hit) {
    Cell cell;
    const auto value = [](int x, int) { return x < 96 ? 0.0 : 1.0; };
    cell.fill(samples, value, hit);
    return cell.guard();
  };
  EXPECT_EQ(black_beside_lit(16, false), Guard::none);
  EXPECT_EQ(black_beside_lit(32, true), Guard::too_dark);
  EXPECT_EQ(black_beside_lit(64, true), Guard::none);
}

TEST(Guards, StandCellsOfAnySizeAndWithoutSamples) {
  for (const Region& region : {Region{64, 64, 65, 65}, Region{0, 0, 1, 64}, Region{63, 3, 80, 5}}) {
    Cell cell(region);
    EXPECT_NE(cell.guard(), Guard::none) << "nothing seen";
    cell.fill(64, [](int, int) { return 1.0; });
    EXPECT_EQ(cell.guard(), Guard::none);
  }
}

}  // namespace
}  // namespace tessera
