// SPDX-License-Identifier: Apache-2.0
#include "core/quality/estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace tessera {
namespace {

Image constant(const Region& region, float value) { return Image(region, 3, value); }

Image noise(const Region& region, unsigned seed, float mean, float deviation) {
  Image image(region, 3);
  std::mt19937 random(seed);
  std::normal_distribution<float> value(mean, deviation);
  for (float& v : image.data()) v = value(random);
  return image;
}

// Blends every pixel with the mean of its row's neighbours: a filter with bias and variance of its own.
Image smoothed(const Image& in) {
  Image out = in;
  const Region r = in.region();
  for (int c = 0; c < 3; ++c)
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0 + 1; x + 1 < r.x1; ++x)
        out.at(c, x, y) = 0.9f * (in.at(c, x - 1, y) + in.at(c, x, y) + in.at(c, x + 1, y)) / 3;
  return out;
}

double mean_square(const Image& x, const Image& truth, const Image& weight, const Region& cell) {
  double sum = 0;
  for (int c = 0; c < 3; ++c)
    for (int y = cell.y0; y < cell.y1; ++y)
      for (int u = cell.x0; u < cell.x1; ++u) {
        const double d = double(x.at(c, u, y)) - truth.at(c, u, y);
        sum += weight.at(c, u, y) * d * d;
      }
  return sum / (3.0 * static_cast<double>(cell.area()));
}

struct Average {
  double sum = 0, squares = 0, count = 0;
  void add(double v) { sum += v, squares += v * v, ++count; }
  double mean() const { return sum / count; }
  double error() const { return std::sqrt((squares / count - mean() * mean()) / (count - 1)); }
};

TEST(Estimate, OfTheHalvesHasTheMeanOfTheTrueErrorBiasIncluded) {
  const Region cell{64, 0, 128, 50};
  const Image truth = noise(cell, 1, 1.0f, 0.2f), weight = constant(cell, 2.0f);
  Average difference;
  for (unsigned seed = 0; seed < 100; ++seed) {
    Image a = truth, b = truth;
    const Image na = noise(cell, 2 * seed + 10, 0, 0.3f), nb = noise(cell, 2 * seed + 11, 0, 0.3f);
    for (std::size_t i = 0; i < a.data().size(); ++i)
      a.data()[i] += na.data()[i], b.data()[i] += nb.data()[i];
    const Image xa = smoothed(a), xb = smoothed(b);
    Image y = xa;
    for (std::size_t i = 0; i < y.data().size(); ++i) y.data()[i] = 0.5f * (xa.data()[i] + xb.data()[i]);
    difference.add(estimate_from_halves({a, b, xa, xb}, weight, cell).mean -
                   mean_square(y, truth, weight, cell));
  }
  EXPECT_LT(std::abs(difference.mean()), 4 * difference.error());
  EXPECT_LT(difference.error(), 0.002) << "the errors themselves are about 0.1";
}

TEST(Estimate, OfTheHoldOutHasTheMeanOfTheTrueErrorOfAnyImage) {
  const Region cell{0, 0, 64, 64};
  const Image truth = constant(cell, 0.5f), weight = constant(cell, 1.0f), wrong = noise(cell, 3, 0.6f, 0.1f);
  Average difference;
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Image c1 = noise(cell, 2 * seed + 10, 0.5f, 0.3f), c2 = noise(cell, 2 * seed + 11, 0.5f, 0.3f);
    difference.add(estimate_from_hold_out(wrong, c1, c2, weight, cell).mean -
                   mean_square(wrong, truth, weight, cell));
  }
  EXPECT_LT(std::abs(difference.mean()), 4 * difference.error());
  EXPECT_LT(difference.error(), 0.001);
}

// T of halves that differ by d and are not filtered is d^2 / 4.
ErrorEstimate of_squares(const Region& cell, const Image& t) {
  Image a(cell, 3);
  for (std::size_t i = 0; i < a.data().size(); ++i) a.data()[i] = 2 * std::sqrt(t.data()[i]);
  const Image b = constant(cell, 0.0f);
  return estimate_from_halves({a, b, a, b}, constant(cell, 1.0f), cell);
}

TEST(Jackknife, IsTheErrorOfTheMeanOfEqualBlocks) {
  const Region cell{0, 0, 64, 64};
  Image t(cell, 3);
  double sum = 0, squares = 0;
  for (int i = 0; i < 64; ++i) {
    const double value = (i * 37 % 64) / 16.0;
    sum += value, squares += value * value;
    for (int c = 0; c < 3; ++c)
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) t.at(c, i % 8 * 8 + x, i / 8 * 8 + y) = static_cast<float>(value);
  }
  const ErrorEstimate e = of_squares(cell, t);
  const double sample_variance = (squares - sum * sum / 64) / 63;
  EXPECT_NEAR(e.mean, sum / 64, 1e-6);
  EXPECT_NEAR(e.standard_error, std::sqrt(sample_variance / 64), 0.02 * e.standard_error)
      << "t for 63 degrees";
  EXPECT_GT(e.standard_error, std::sqrt(sample_variance / 64));
}

TEST(Jackknife, BoundsTheTruthNineteenTimesInTwentyEvenForOddAndSmallCells) {
  for (const Region& cell : {Region{0, 0, 64, 64}, Region{64, 64, 128, 93}, Region{0, 64, 17, 80},
                             Region{3, 0, 20, 9}, Region{64, 0, 65, 64}}) {
    int covered = 0;
    constexpr int kRuns = 600;
    for (unsigned seed = 0; seed < kRuns; ++seed) {
      Image t(cell, 3);
      std::mt19937 random(seed);
      std::exponential_distribution<float> value(1.0f);  // mean 1, for all channels
      for (int y = cell.y0; y < cell.y1; ++y)
        for (int x = cell.x0; x < cell.x1; ++x) {
          const float v = value(random);
          for (int c = 0; c < 3; ++c) t.at(c, x, y) = v;
        }
      covered += of_squares(cell, t).upper(1.645) >= 1.0;
    }
    // 3 % below 95 % for the skew of exponential blocks; 3.3 deviations of a share of 600 are 3.6 %.
    EXPECT_GT(covered, (0.95 - 0.03 - 0.036) * kRuns) << cell.width() << " x " << cell.height();
  }
}

TEST(Jackknife, DoesNotTrustFewerThanFourBlocks) {
  for (const Region& cell : {Region{64, 64, 65, 65}, Region{8, 8, 16, 16}, Region{64, 0, 72, 16}}) {
    const ErrorEstimate e = of_squares(cell, constant(cell, 0.25f));
    EXPECT_NEAR(e.mean, 0.25, 1e-7);
    EXPECT_GE(e.standard_error, e.mean);
  }
  const ErrorEstimate e = of_squares({0, 0, 16, 16}, constant({0, 0, 16, 16}, 0.25f));
  EXPECT_NEAR(e.standard_error, 0, 1e-7) << "four equal blocks";
}

TEST(Estimate, OfValuesThatAreNotFiniteIsInfinite) {
  const Region cell{0, 0, 9, 9};
  const Image good = constant(cell, 1.0f);
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    Image broken = good;
    broken.at(2, 8, 8) = bad;
    const ErrorEstimate e = estimate_from_halves({broken, good, good, good}, good, cell);
    EXPECT_TRUE(std::isinf(e.mean) && e.mean > 0 && e.standard_error == 0);
    EXPECT_TRUE(std::isinf(estimate_from_hold_out(good, good, broken, good, cell).upper(0)));
  }
}

TEST(RelativeWeight, IsTheReciprocalSquareOfTheMeanAround) {
  const Region frame{0, 0, 40, 30};
  Image y(frame, 3);
  for (int c = 0; c < 3; ++c)
    for (int v = 0; v < 30; ++v)
      for (int u = 0; u < 40; ++u) y.at(c, u, v) = static_cast<float>(c + u * 0.25 + v * 0.5);
  const Image w = relative_weight(y, {0, 0, 40, 30});
  const auto expected = [](double r) { return 1 / (r * r + 0.01); };
  EXPECT_NEAR(w.at(1, 20, 15), expected(1 + 5 + 7.5), 1e-6) << "the mean of a ramp is its middle";
  EXPECT_NEAR(w.at(0, 0, 0), expected(0.25 * 2 + 0.5 * 2), 1e-5) << "of 5 x 5 pixels in a corner";
  EXPECT_NEAR(w.at(2, 39, 29), expected(2 + 0.25 * 37 + 0.5 * 27), 1e-6);
  const Image dark = relative_weight(constant(frame, -3.0f), frame);
  EXPECT_FLOAT_EQ(dark.at(0, 5, 5), 100.0f) << "what is below black counts as black";
}

TEST(RelativeWeight, HasTheSameBitsWhateverPartOfTheFrameIsAskedFor) {
  const Region frame{-5, 3, 150, 140};
  const Image y = noise(frame, 4, 1.0f, 0.5f);
  const Image whole = relative_weight(y, frame);
  for (const Size size : {Size{64, 64}, Size{37, 53}, Size{1, 7}, Size{155, 1}})
    for (const Region& part : grid_cells(frame, size)) {
      const Image around = cropped(y, intersect(grown(part, kWeightRadius), frame));
      ASSERT_TRUE(same_bits(relative_weight(around, part), cropped(whole, part))) << size.width;
    }
}

TEST(Pooled, IsTheMeanOverPixels) {
  const ErrorEstimate e = pooled({{1.0, 0.3}, {5.0, 0.4}}, {3, 1});
  EXPECT_DOUBLE_EQ(e.mean, 2.0);
  EXPECT_DOUBLE_EQ(e.standard_error, std::hypot(0.9, 0.4) / 4);
}

}  // namespace
}  // namespace tessera
