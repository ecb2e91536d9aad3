// SPDX-License-Identifier: Apache-2.0
#include "core/quality/error_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace tessera {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// One row of values, shuffled: order must not matter.
ErrorMap row_of(std::vector<double> values) {
  std::ranges::shuffle(values, std::mt19937(7));
  return {{0, 0, static_cast<int>(values.size()), 1}, std::move(values)};
}

TEST(ErrorMap, PercentilesAreValuesThatOccur) {
  std::vector<double> values(200);
  for (int i = 0; i < 200; ++i) values[static_cast<std::size_t>(i)] = i + 1;
  EXPECT_EQ(percentile(row_of(values), 0.99), 198);
  EXPECT_EQ(percentile(row_of(values), 0.5), 100);
  EXPECT_EQ(percentile(row_of(values), 1.0), 200);
  EXPECT_EQ(percentile(row_of({3}), 0.01), 3);
}

TEST(ErrorMap, TheWeightedMedianHasHalfOfTheErrorBelow) {
  EXPECT_EQ(weighted_median(row_of({1, 1, 1, 1, 1, 1, 1, 3, 5})), 3);  // of 15, 7 are below 3 and 10 up to it
  EXPECT_EQ(weighted_median(row_of({0, 0, 0, 0, 0, 0.5})), 0.5) << "pixels without an error have no weight";
  EXPECT_EQ(weighted_median(row_of({0, 0})), 0);
}

TEST(ErrorMap, NothingThatIsNotFiniteIsHidden) {
  for (const double bad : {kNan, kInfinity}) {
    const ErrorMap map = row_of({1, 2, bad});
    EXPECT_FALSE(std::isfinite(mean(map)) || std::isfinite(trimmed_mean(map)));
    EXPECT_FALSE(std::isfinite(weighted_median(map)) || std::isfinite(percentile(map, 1.0)));
    EXPECT_FALSE(std::isfinite(largest(map)) || std::isfinite(by_cells(map)[0].worst_block));
  }
  EXPECT_TRUE(std::isnan(percentile(row_of({1, 2, kNan}), 0.1)));
}

TEST(ErrorMap, OfNoPixelsKnowsNothing) {
  const ErrorMap none;
  EXPECT_TRUE(std::isnan(mean(none)) && std::isnan(percentile(none, 0.5)) && std::isnan(largest(none)));
  EXPECT_TRUE(by_cells(none).empty());
}

TEST(ErrorMap, CellsAreThoseOfTheGlobalGrid) {
  const Region frame{-10, 60, 70, 130};  // cells begin at -64, 0 and 64
  ErrorMap map{frame, std::vector<double>(static_cast<std::size_t>(frame.area()))};
  const auto at = [&](int x, int y) -> double& {
    return map.values[static_cast<std::size_t>((y - frame.y0) * frame.width() + x - frame.x0)];
  };
  for (int y = 64; y < 128; ++y)
    for (int x = 0; x < 64; ++x) at(x, y) = 1;
  for (int y = 72; y < 80; ++y)
    for (int x = 16; x < 24; ++x) at(x, y) = 65;
  const std::vector<CellErrors> cells = by_cells(map);
  ASSERT_EQ(cells.size(), 9u);
  EXPECT_EQ(cells[0].cell, (Region{-10, 60, 0, 64}));
  EXPECT_EQ(cells[8].cell, (Region{64, 128, 70, 130}));
  for (const std::size_t i : {0u, 1u, 2u, 3u, 5u, 6u, 7u, 8u}) EXPECT_EQ(cells[i].mean, 0);
  EXPECT_DOUBLE_EQ(cells[4].mean, 1 + 64 * 64.0 / 4096);
  EXPECT_EQ(cells[4].percentile_99, 65);  // the block is 1.6 % of the cell
  EXPECT_EQ(cells[4].worst_block, 65);
}

}  // namespace
}  // namespace tessera
