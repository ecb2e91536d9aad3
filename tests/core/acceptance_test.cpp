// SPDX-License-Identifier: Apache-2.0
#include "core/acceptance.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace tessera {
namespace {

constexpr double kTarget = 0.01;
constexpr std::int64_t kFull = kCellEdge * kCellEdge;

AcceptanceRule rule_to(double target) { return {.relmse = target, .first_samples = 16, .max_samples = 1024}; }

// An estimate whose upper bound at 1.645 standard errors is `bound` targets, and at 2.5 well above.
ErrorEstimate bounded(double bound) { return {0.5 * bound * kTarget, 0.5 * bound * kTarget / 1.645}; }

// A frame of cells that all look alike, and what the rule remembers of them.
struct Frame {
  int columns = 3, rows = 3;
  AcceptanceRule rule = rule_to(kTarget);
  std::vector<CellLook> looks =
      std::vector<CellLook>(std::size_t(columns) * rows, {16, bounded(0.9), {}, {}});
  std::vector<std::int64_t> areas = std::vector<std::int64_t>(looks.size(), kFull);
  std::vector<CellState> states;
  Decision last;

  const Decision& look(const Budget& budget = {}) {
    last = decide(rule, columns, areas, states, looks, budget);
    states = last.cells;
    for (std::size_t i = 0; i < looks.size(); ++i) looks[i].samples = last.want[i];
    return last;
  }
  CellStatus status(int cell) const { return last.cells[cell].status; }
};

TEST(Acceptance, TakesTwoGoodLooksInARowWithNewSamplesBetween) {
  Frame frame;
  EXPECT_FALSE(frame.look().stop);
  EXPECT_EQ(frame.last.want, std::vector<int>(9, 32)) << "a second look needs new samples";
  EXPECT_EQ(frame.last.acceptable_share, 0.0);
  EXPECT_EQ(frame.look().stop, StopReason::accepted);
  EXPECT_EQ(frame.last.want, std::vector<int>(9, 32));
  EXPECT_EQ(frame.last.acceptable_share, 1.0);
}

TEST(Acceptance, ABadLookBetweenTwoGoodOnesStartsOver) {
  Frame frame;
  frame.look();
  for (CellLook& look : frame.looks) look.error = bounded(1.1);
  EXPECT_FALSE(frame.look().stop);
  for (CellLook& look : frame.looks) look.error = bounded(0.9);
  EXPECT_FALSE(frame.look().stop);
  EXPECT_TRUE(frame.look().stop);
}

TEST(Acceptance, OneLookIsEnoughTwoAndAHalfStandardErrorsBelow) {
  Frame frame;
  for (CellLook& look : frame.looks) look.error = {0.4 * kTarget, 0.23 * kTarget};
  EXPECT_EQ(frame.look().stop, StopReason::accepted);
  Frame near;
  for (CellLook& look : near.looks) look.error = {0.4 * kTarget, 0.25 * kTarget};
  EXPECT_FALSE(near.look().stop);
}

TEST(Acceptance, ACellWhoseHoldOutDisagreedAtItsLastSamplesIsNotAcceptedLaterWithoutNewOnes) {
  Frame frame;
  frame.rule.max_samples = 32;
  frame.look();
  frame.looks[4].hold_out = bounded(1.2);
  frame.looks[0].error = bounded(2.0);
  frame.look();
  EXPECT_EQ(frame.status(4), CellStatus::exhausted);
  for (CellLook& look : frame.looks) look.hold_out.reset();  // nothing new was rendered there
  frame.look();
  EXPECT_EQ(frame.status(4), CellStatus::exhausted);
}

TEST(Acceptance, TheHoldOutMustAgreeAtTheSecondLook) {
  Frame frame;
  frame.look();
  frame.looks[4].hold_out = bounded(1.2);
  EXPECT_FALSE(frame.look().stop);
  EXPECT_EQ(frame.status(4), CellStatus::open);
  EXPECT_EQ(frame.status(0), CellStatus::accepted);
  frame.looks[4].hold_out = bounded(0.9);
  EXPECT_EQ(frame.look().stop, StopReason::accepted);
}

TEST(Acceptance, AGuardKeepsACellOpenAndIsReportedWhenSamplesRunOut) {
  Frame frame;
  for (CellLook& look : frame.looks) look.error = {0.1 * kTarget, 0};
  frame.looks[4].guard = Guard::heavy_tails;
  while (!frame.look().stop) EXPECT_EQ(frame.status(4), CellStatus::open);
  EXPECT_EQ(frame.last.stop, StopReason::max_samples);
  EXPECT_EQ(frame.status(4), CellStatus::exhausted);
  EXPECT_EQ(frame.last.cells[4].guard, Guard::heavy_tails);
  EXPECT_EQ(frame.last.cells[4].samples, 1024);
  EXPECT_NEAR(frame.last.acceptable_share, 8.0 / 9, 1e-12);
}

TEST(Acceptance, ACellMayNotRestBesideOneFourTimesAboveTheTarget) {
  Frame frame{.columns = 9, .rows = 1};
  for (CellLook& look : frame.looks) look.error = {0.1 * kTarget, 0};
  frame.looks[4].error = bounded(4.1);
  frame.look();
  for (int i = 0; i < 9; ++i)
    EXPECT_EQ(frame.status(i), std::abs(i - 4) <= 1 ? CellStatus::open : CellStatus::accepted) << i;
  frame.looks[4].error = bounded(3.9);
  frame.look();
  for (int i = 0; i < 9; ++i)
    EXPECT_EQ(frame.status(i), i == 4 ? CellStatus::open : CellStatus::accepted) << i;
}

TEST(Acceptance, NeighboursAreThoseAroundInRowsAndColumnsOnly) {
  Frame frame{.columns = 3, .rows = 3};
  for (CellLook& look : frame.looks) look.error = {0.1 * kTarget, 0};
  frame.looks[5].error = bounded(5);  // the right end of the middle row
  frame.look();
  for (int i = 0; i < 9; ++i)
    EXPECT_EQ(frame.status(i), i % 3 == 0 ? CellStatus::accepted : CellStatus::open) << i;
}

TEST(Acceptance, ACellAtRestOpensAgainWhenItsNeighboursSamplesShowItWasWrong) {
  Frame frame;
  for (CellLook& look : frame.looks) look.error = {0.1 * kTarget, 0};
  frame.looks[8].error = bounded(2);
  frame.look();
  EXPECT_EQ(frame.status(0), CellStatus::accepted);
  frame.looks[0].error = {1.4 * kTarget, 0};
  frame.look();
  EXPECT_EQ(frame.status(0), CellStatus::accepted) << "1.5 targets are the limit";
  frame.looks[0].error = {1.6 * kTarget, 0};
  frame.look();
  EXPECT_EQ(frame.status(0), CellStatus::open);
  EXPECT_EQ(frame.last.cells[0].good_looks, 0);
  EXPECT_EQ(frame.last.want[0], 32);
}

TEST(Acceptance, TheSameSamplesSeenTwiceAreOneLook) {
  Frame frame;
  frame.look();
  for (CellLook& look : frame.looks) look.samples = 16;
  EXPECT_FALSE(frame.look().stop);
  EXPECT_TRUE(frame.look().stop);
}

TEST(Acceptance, WhenEveryCellRestsTheFramesOwnBoundStillDecides) {
  Frame frame;
  for (CellLook& look : frame.looks) look.error = {0.1 * kTarget, 0};
  frame.looks[8].error = bounded(2);
  frame.look();
  ASSERT_EQ(frame.status(0), CellStatus::accepted);
  for (CellLook& look : frame.looks) look.error = {1.4 * kTarget, 0};
  frame.looks[8].error = {0.1 * kTarget, 0};
  EXPECT_FALSE(frame.look().stop);
  EXPECT_EQ(frame.status(0), CellStatus::open);
  EXPECT_EQ(frame.status(8), CellStatus::accepted);
}

TEST(Acceptance, TheFramesErrorIsTheMeanOverPixels) {
  Frame frame{.columns = 2, .rows = 1};
  frame.looks[0].error = {0.002, 0.003};
  frame.looks[1].error = {0.010, 0.004};
  frame.areas = {3 * kFull, kFull};
  frame.look();
  EXPECT_NEAR(frame.last.frame.mean, (3 * 0.002 + 0.010) / 4, 1e-15);
  EXPECT_NEAR(frame.last.frame.standard_error, std::hypot(3 * 0.003, 0.004) / 4, 1e-15);
}

TEST(Acceptance, ASmallCellAtTheEdgeIsJudgedWithItsNeighbours) {
  Frame frame{.columns = 3, .rows = 1};
  for (CellLook& look : frame.looks) look.error = {0.1 * kTarget, 0};
  frame.looks[2].error = bounded(5);
  frame.areas[2] = 64;
  EXPECT_EQ(frame.look().stop, StopReason::accepted) << "64 pixels at 5 targets beside 4096 at 0.1";
  frame.areas[2] = kFull;
  frame.states.clear();
  EXPECT_FALSE(frame.look().stop);
}

TEST(Acceptance, WithoutATargetAllSamplesAreTakenAtOnceOrByDoublingUnderATimeLimit) {
  AcceptanceRule rule{.first_samples = 16, .max_samples = 64};
  EXPECT_EQ(first_round(rule, 2), (std::vector<int>{64, 64}));
  rule.max_seconds = 10;
  EXPECT_EQ(first_round(rule, 2), (std::vector<int>{16, 16}));
  const std::vector<std::int64_t> areas{kFull, kFull};
  const std::vector<CellLook> at16(2, {16, {}, {}, {}}), at64(2, {64, {}, {}, {}});
  const Decision early = decide(rule, 2, areas, {}, at16, {});
  EXPECT_FALSE(early.stop);
  EXPECT_EQ(early.want, (std::vector<int>{32, 32}));
  EXPECT_EQ(decide(rule, 2, areas, early.cells, at16, {.seconds = 10}).stop, StopReason::max_seconds);
  EXPECT_EQ(decide(rule, 2, areas, early.cells, at64, {.seconds = 10}).stop, StopReason::max_samples);
  EXPECT_EQ(decide(rule, 2, areas, early.cells, at64, {}).acceptable_share, 1.0);
}

TEST(Acceptance, TimeStopsWhatIsNotAccepted) {
  Frame frame;
  frame.rule.max_seconds = 60;
  EXPECT_EQ(first_round(frame.rule, 1), std::vector<int>{16});
  EXPECT_EQ(frame.look({.seconds = 60}).stop, StopReason::max_seconds);
  EXPECT_EQ(frame.last.want, std::vector<int>(9, 16));
  Frame done;
  for (CellLook& look : done.looks) look.error = {};
  done.rule.max_seconds = 60;
  EXPECT_EQ(done.look({.seconds = 1e9}).stop, StopReason::accepted);
}

TEST(Acceptance, AnInfiniteEstimateIsNeverAccepted) {
  Frame frame;
  for (CellLook& look : frame.looks) look.error = {0.1 * kTarget, 0};
  frame.looks[4].error = {std::numeric_limits<double>::infinity(), 0};
  while (!frame.look().stop) {
  }
  EXPECT_EQ(frame.last.stop, StopReason::max_samples);
  EXPECT_EQ(frame.status(4), CellStatus::exhausted);
}

// Whatever the looks say: at most a doubling a round, neighbours within a factor of four, nobody beyond the
// limit, an end within the rounds that doublings allow, and rest only where the rule grants it.
TEST(Acceptance, KeepsItsPromisesUnderRandomLooks) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    Frame frame{.columns = 1 + int(random() % 6), .rows = 1 + int(random() % 6)};
    for (auto& area : frame.areas) area = 1 + random() % kFull;
    std::lognormal_distribution<double> mean(std::log(kTarget), 2.0), error(std::log(0.3 * kTarget), 1.0);
    std::vector<int> have(frame.looks.size(), 16);
    for (int round = 0;; ++round) {
      ASSERT_LT(round, 300) << "seed " << seed;
      for (CellLook& look : frame.looks) {
        look.error = {mean(random) * 16 / look.samples, error(random)};
        look.guard = random() % 20 ? Guard::none : Guard::too_dark;
      }
      const Decision& d = frame.look();
      bool more = false;
      for (int i = 0; i < int(have.size()); ++i) {
        ASSERT_TRUE(d.want[i] == have[i] || d.want[i] == 2 * have[i]) << "seed " << seed;
        ASSERT_LE(d.want[i], frame.rule.max_samples);
        if (d.cells[i].status == CellStatus::open && !d.stop) {
          ASSERT_EQ(d.want[i], 2 * have[i]);
        }
        if (d.cells[i].status == CellStatus::exhausted) {
          ASSERT_EQ(have[i], frame.rule.max_samples);
        }
        more = more || d.want[i] > have[i];
        for (int j = 0; j < int(have.size()); ++j)
          if (std::abs(i % frame.columns - j % frame.columns) <= 1 &&
              std::abs(i / frame.columns - j / frame.columns) <= 1) {
            ASSERT_LE(d.want[i], 4 * d.want[j]) << "seed " << seed;
          }
      }
      ASSERT_NE(more, d.stop.has_value()) << "seed " << seed;
      if (d.stop) break;
      have = d.want;
    }
  }
}

}  // namespace
}  // namespace tessera
