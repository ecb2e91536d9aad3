// SPDX-License-Identifier: Apache-2.0
#include "cli/progress_display.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using ::testing::HasSubstr;

const Progress kHalf{.round = 2,
                     .samples_done = 5'000'000,
                     .tiles_done = 1,
                     .tiles_round = 4,
                     .error = 0.01,
                     .target = 0.0025,
                     .acceptable_share = 0.25,
                     .seconds = 65,
                     .fraction = 0.5,
                     .seconds_left = 65};

TEST(ProgressDisplay, LinesAreWhatFarmManagersRead) {
  EXPECT_EQ(progress_text(ProgressStyle::lines, kHalf), "Progress: 50.0%");
  EXPECT_EQ(progress_text(ProgressStyle::openjd, kHalf), "openjd_progress: 50.0");
}

TEST(ProgressDisplay, ABarSaysRoundTilesSamplesErrorTargetAndTimeLeftAndFitsItsLine) {
  const std::string bar = progress_text(ProgressStyle::bar, kHalf, 160);
  for (const char* part : {"50%", "round 2", "5.0M samples", "tiles 1/4", "0.0100 -> 0.0025", "25% of cells",
                           "1:05", "~1:05 left"})
    EXPECT_THAT(bar, HasSubstr(part));
  for (const int columns : {1, 20, 80, 120})
    EXPECT_LT(progress_text(ProgressStyle::bar, kHalf, columns).size(), columns + 1u);
}

TEST(ProgressDisplay, JsonIsAnObjectALine) {
  const std::string json = progress_text(ProgressStyle::json, kHalf);
  EXPECT_THAT(json, HasSubstr(R"("progress":0.50000)"));
  EXPECT_THAT(json, HasSubstr(R"("target":0.0025)"));
  EXPECT_EQ(json.find('\n'), std::string::npos);
}

TEST(ProgressDisplay, ThePercentageNeverFallsAndSilenceIsNeverLong) {
  std::FILE* file = std::tmpfile();
  ASSERT_NE(file, nullptr);
  {
    ProgressDisplay display(ProgressStyle::lines, file);
    display.show({.round = 1, .seconds = 0, .fraction = 0.5});
    display.show({.round = 1, .seconds = 1, .fraction = 0.501});  // too little, too soon
    display.show({.round = 2, .seconds = 2, .fraction = 0.3});    // the estimate grew
    display.show({.round = 2, .seconds = 33, .fraction = 0.3});   // half a minute went by
  }
  std::rewind(file);
  std::string text(200, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file));
  std::fclose(file);
  EXPECT_EQ(text, "Progress: 50.0%\nProgress: 50.1%\nProgress: 50.1%\n");
}

TEST(ProgressDisplay, TheUsualStyleFollowsWhereItRuns) {
  EXPECT_EQ(usual_progress_style(true, nullptr), ProgressStyle::bar);
  EXPECT_EQ(usual_progress_style(false, nullptr), ProgressStyle::lines);
  EXPECT_EQ(usual_progress_style(true, "/sessions/1"), ProgressStyle::openjd);
}

}  // namespace
}  // namespace tessera
