// SPDX-License-Identifier: Apache-2.0
#include "worker/render/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace tessera::tracer {
namespace {

Vec2 pair(std::uint64_t key, int sample, std::uint32_t set) {
  return random_pair(key, half_index_reversed(sample), set);
}

// The points of one half: sample indices 2 i + half.
std::vector<Vec2> points(std::uint64_t key, int half, std::uint32_t set, int n) {
  std::vector<Vec2> all;
  for (int i = 0; i < n; ++i) all.push_back(pair(key, 2 * i + half, set));
  return all;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - 0.5) * (b[i] - 0.5);
  return 12 * sum / static_cast<double>(a.size());
}

TEST(Sampler, EveryAlignedPowerOfTwoOfAHalfIsAZeroTwoNet) {
  for (const int half : {0, 1})
    for (std::uint32_t set = 0; set < 20; ++set) {
      const std::uint64_t key = half_key(99, 2, 17 + static_cast<int>(set), 5, half);
      const std::vector<Vec2> all = points(key, half, set, 128);
      for (int m = 0; m <= 7; ++m)
        for (int begin = 0; begin < 128; begin += 1 << m)
          for (int a = 0; a <= m; ++a) {
            std::set<std::pair<int, int>> boxes;
            for (int i = begin; i < begin + (1 << m); ++i)
              boxes.insert({int(all[std::size_t(i)].x * float(1 << a)),
                            int(all[std::size_t(i)].y * float(1 << (m - a)))});
            ASSERT_EQ(boxes.size(), std::size_t(1) << m) << "set " << set << " from " << begin;
          }
    }
}

TEST(Sampler, NumbersLieInTheHalfOpenUnitInterval) {
  for (int i = 0; i < 100000; ++i) {
    const Vec2 u = pair(mixed(static_cast<std::uint64_t>(i)), i, static_cast<std::uint32_t>(i % 7));
    ASSERT_TRUE(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1);
  }
}

// Means over pixels of one sample are uniform: the scramble itself has no bias.
TEST(Sampler, EachSampleIsUniformOverThePixels) {
  constexpr int kEdge = 128, kBins = 16;
  for (const int sample : {0, 1, 7, 32}) {
    std::vector<double> count(kBins * kBins);
    for (int y = 0; y < kEdge; ++y)
      for (int x = 0; x < kEdge; ++x) {
        const Vec2 u = pair(half_key(1, 0, x, y, sample & 1), sample, 3);
        ++count[static_cast<std::size_t>(int(u.x * kBins) * kBins + int(u.y * kBins))];
      }
    double chi2 = 0;
    constexpr double kExpected = double(kEdge) * kEdge / (kBins * kBins);
    for (const double c : count) chi2 += (c - kExpected) * (c - kExpected) / kExpected;
    // Mean 255, standard deviation sqrt(510): five of them.
    EXPECT_LT(chi2, 255 + 5 * std::sqrt(510)) << "sample " << sample;
  }
}

TEST(Sampler, HalvesSetsPixelsFramesAndSeedsAreUncorrelated) {
  constexpr int kPixels = 20000;
  const auto series = [](auto number) {
    std::vector<double> all;
    for (int i = 0; i < kPixels; ++i) all.push_back(number(i));
    return all;
  };
  const auto first = [](std::uint64_t key, int sample, std::uint32_t set) {
    return double(pair(key, sample, set).x);
  };
  const auto base = series([&](int i) { return first(half_key(5, 0, i, 0, 0), 6, 2); });
  // The standard error of a correlation of independent series is 1 / sqrt(n).
  const double bound = 5 / std::sqrt(double(kPixels));
  const auto expect_apart = [&](const char* what, auto number) {
    EXPECT_LT(std::abs(correlation(base, series(number))), bound) << what;
  };
  expect_apart("the other half", [&](int i) { return first(half_key(5, 0, i, 0, 1), 7, 2); });
  expect_apart("the next set", [&](int i) { return first(half_key(5, 0, i, 0, 0), 6, 3); });
  expect_apart("the next pixel", [&](int i) { return first(half_key(5, 0, i + 1, 0, 0), 6, 2); });
  expect_apart("the next row", [&](int i) { return first(half_key(5, 0, i, 1, 0), 6, 2); });
  expect_apart("the next frame", [&](int i) { return first(half_key(5, 1, i, 0, 0), 6, 2); });
  expect_apart("the next seed", [&](int i) { return first(half_key(6, 0, i, 0, 0), 6, 2); });
  expect_apart("the other coordinate", [&](int i) { return double(pair(half_key(5, 0, i, 0, 0), 6, 2).y); });
}

TEST(Sampler, PixelsSideBySideDrawWhatEachWouldAlone) {
  std::array<std::uint64_t, 16> keys;
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = half_key(3, 1, static_cast<int>(i), 41, 0);
  RandomPairs<16> pairs;
  pairs.draw(keys, half_index_reversed(12), 9);
  for (std::size_t i = 0; i < keys.size(); ++i) EXPECT_EQ(pairs[i], pair(keys[i], 12, 9));
}

TEST(Sampler, TheSecondDimensionIsSobols) {
  // Direction numbers of Sobol's second dimension: v[0] = 1/2, v[i] = v[i-1] ^ (v[i-1] >> 1).
  std::vector<std::uint32_t> v{0x80000000u};
  while (v.size() < 32) v.push_back(v.back() ^ (v.back() >> 1));
  for (std::uint32_t i = 0; i < 5000; ++i) {
    std::uint32_t expected = 0;
    for (std::size_t b = 0; b < 32; ++b)
      if (i >> b & 1) expected ^= v[b];
    ASSERT_EQ(reversed_bits(sobol_second_reversed(i)), expected) << i;
  }
}

}  // namespace
}  // namespace tessera::tracer
