// SPDX-License-Identifier: Apache-2.0
#include "cli/watch_screen.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "cli/cell_map.h"
#include "cli/error_graph.h"
#include "cli/terminal_text.h"

namespace tessera {
namespace {

using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr CellStatus kOpen = CellStatus::open, kGood = CellStatus::accepted, kSpent = CellStatus::exhausted;

int count(const std::vector<std::string>& lines, std::string_view what) {
  int n = 0;
  for (const std::string& line : lines)
    for (std::size_t at = 0; (at = line.find(what, at)) != line.npos; at += what.size()) ++n;
  return n;
}

WatchView view(std::size_t frames) {
  WatchView v{.job = {.job = "atrium", .state = JobState::active, .frames = 60, .fraction = 0.4}};
  v.job.seconds_left = 75;
  for (std::size_t i = 0; i < frames; ++i) {
    FrameSummary f{.frame = 7 + static_cast<int>(i), .state = FrameState::active, .round = 3};
    f.errors = {0.5f, 0.1f, 0.03f};
    f.error = 0.03;
    f.target = 0.0025;
    f.columns = 30;
    f.cells.assign(30 * 17, kGood);
    f.cells[4] = kOpen;
    v.frames.push_back(f);
  }
  v.workers = {{.id = "a", .slots = 4, .held = 5}, {.id = "b", .slots = 2, .set_aside = "it failed"}};
  v.events = {{1, 0, "begun"}, {2, 0, "worker b failed a task"}};
  return v;
}

TEST(WatchScreen, NeverLeavesTheScreen) {
  for (const std::size_t frames : {0u, 1u, 2u, 9u})
    for (const bool colours : {false, true})
      for (int columns = 1; columns < 200; columns += 7)
        for (int rows = 1; rows < 60; rows += 5) {
          const auto lines = watch_screen(view(frames), {columns, rows}, colours);
          ASSERT_LE(lines.size(), static_cast<std::size_t>(rows)) << columns << "x" << rows;
          for (const std::string& line : lines) ASSERT_LE(shown_width(line), columns) << line;
        }
}

TEST(WatchScreen, SaysHowTheJobItsFramesAndTheWorkersAre) {
  std::string all;
  for (const std::string& line : watch_screen(view(2), {120, 40}, false)) all += line + "\n";
  for (const char* words : {"atrium", "active", "40.0 %", "1 min 15 s left", "frame 7", "frame 8", "round 3",
                            "relMSE 0.03 of 0.0025", "workers: 2, 6 slots, 5 tasks in hand, 1 set aside",
                            "worker b failed a task"})
    EXPECT_THAT(all, HasSubstr(words));
  EXPECT_EQ(all.find('\x1b'), all.npos) << "no colours were asked for";
}

TEST(WatchScreen, StrangersCannotCommandTheTerminal) {
  WatchView v = view(1);
  v.job.job = "a\x1b[2Jb";
  v.job.reason =
      "c\nd\xc2\x9b"
      "2J\xff";
  v.events.back().text = "\x1b]0;title\a";
  for (const std::string& line : watch_screen(v, {100, 30}, false))
    for (const char c : line) ASSERT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) << line;
  EXPECT_EQ(plain("c\nd\xc2\x9b"
                  "2J\xffé"),
            "c?d?2J?é");
}

TEST(CellMap, ShowsEveryCellWhereThereIsRoom) {
  const std::vector<CellStatus> cells{kOpen, kGood, kSpent, kGood, kGood, kOpen};
  EXPECT_THAT(cell_map(cells, 3, 10, 10, false), testing::ElementsAre("·█x", "██·"));
  const auto coloured = cell_map(cells, 3, 10, 10, true);
  ASSERT_THAT(coloured, SizeIs(1));  // two rows in one
  EXPECT_EQ(shown_width(coloured[0]), 3);
  EXPECT_THAT(coloured[0], HasSubstr("\x1b[33;42m▀"));  // open above, accepted below
}

TEST(CellMap, AnOpenCellIsSeenHoweverManyShareItsBlock) {
  std::vector<CellStatus> cells(100 * 60, kGood);
  for (const int at : {0, 99, 5999, 3050}) {
    cells[static_cast<std::size_t>(at)] = kOpen;
    const auto lines = cell_map(cells, 100, 13, 7, false);
    EXPECT_LE(lines.size(), 7u);
    for (const std::string& line : lines) EXPECT_LE(shown_width(line), 13);
    EXPECT_EQ(count(lines, "·"), 1);
    cells[static_cast<std::size_t>(at)] = kSpent;
    EXPECT_EQ(count(cell_map(cells, 100, 13, 7, false), "x"), 1);
    cells[static_cast<std::size_t>(at)] = kGood;
  }
  EXPECT_THAT(cell_map({}, 0, 10, 10, true), IsEmpty());
}

// The uppermost dot of each column of characters, in dots from above; -1: none.
std::vector<int> tops(const std::vector<std::string>& lines, int columns) {
  std::vector<int> found(static_cast<std::size_t>(columns), -1);
  for (std::size_t row = 0; row < lines.size(); ++row)
    for (std::size_t at = 0, x = 0; at < lines[row].size(); ++x) {
      const std::string& line = lines[row];
      const auto first = static_cast<unsigned char>(line[at]);
      const std::size_t bytes = first < 0x80 ? 1 : 3;
      if (bytes == 3 && first == 0xe2 && static_cast<unsigned char>(line[at + 1]) >= 0xa0) {
        const int dots = (static_cast<unsigned char>(line[at + 1]) - 0xa0) << 6 |
                         (static_cast<unsigned char>(line[at + 2]) & 0x3f);
        const int down = dots & 0x09 ? 0 : dots & 0x12 ? 1 : dots & 0x24 ? 2 : 3;
        if (found[x] < 0) found[x] = static_cast<int>(row) * 4 + down;
      }
      at += bytes;
    }
  return found;
}

TEST(ErrorGraph, OfFallingErrorsFalls) {
  const auto lines = error_graph({1.0f, 0.4f, 0.09f, 0.01f, 0.004f}, 0.001, 40, 8);
  ASSERT_THAT(lines, SizeIs(8));
  for (const std::string& line : lines) EXPECT_EQ(shown_width(line), 40);
  const std::vector<int> top = tops(lines, 40);
  EXPECT_TRUE(std::ranges::is_sorted(top));
  EXPECT_GE(top.front(), 0);
  EXPECT_LT(top.front(), top.back());
}

TEST(ErrorGraph, IsLogarithmic) {
  const std::vector<int> top = tops(error_graph({1.0f, 0.1f, 0.01f}, {}, 41, 20), 41);
  EXPECT_NEAR(top[20], (top[0] + top[40]) / 2.0, 1.5);
}

TEST(ErrorGraph, ShowsTheTargetBelowErrorsThatAreAboveIt) {
  const auto lines = error_graph({1.0f, 0.5f}, 0.001, 20, 10);
  EXPECT_EQ(count(lines, "╌"), 20);
  EXPECT_EQ(count({lines.back()}, "╌"), 20);
  EXPECT_EQ(count(error_graph({1.0f, 0.5f}, {}, 20, 10), "╌"), 0);
}

TEST(ErrorGraph, LeavesOutWhatHasNoLogarithm) {
  EXPECT_THAT(error_graph({0.0f, -1.0f, NAN, INFINITY}, 0.1, 20, 5), IsEmpty());
  EXPECT_THAT(error_graph({0.5f}, 0.1, 20, 5), SizeIs(5));
  EXPECT_THAT(error_graph({0.5f}, 0.1, 7, 5), IsEmpty());
}

TEST(TerminalText, CutsCharactersNotBytesAndSwitchesColoursOff) {
  EXPECT_EQ(cut("äöü", 2), "äö");
  EXPECT_EQ(cut("\x1b[31mabc\x1b[0m", 2), "\x1b[31mab\x1b[0m");
  EXPECT_EQ(shown_width("\x1b[1;31mä\x1b[0mb"), 2);
  EXPECT_EQ(progress_bar(0.5, 4), "██  ");
  EXPECT_EQ(progress_bar(7, 3), "███");
}

}  // namespace
}  // namespace tessera
