// SPDX-License-Identifier: Apache-2.0
#include "core/sequence.h"

#include <gmock/gmock.h>

#include <fstream>

#include "core/error.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Frames, AreRangesStepsAndSingleNumbersInTheOrderGiven) {
  EXPECT_THAT(parse_frames("7"), ElementsAre(7));
  EXPECT_THAT(parse_frames("1-3"), ElementsAre(1, 2, 3));
  EXPECT_THAT(parse_frames("1-10x4,15,0"), ElementsAre(1, 5, 9, 15, 0));
  EXPECT_THAT(parse_frames("-2--1,-5"), ElementsAre(-2, -1, -5));
  EXPECT_THAT(parse_frames("3,1-4"), ElementsAre(3, 1, 2, 4)) << "each once";
}

TEST(Frames, ThatMakeNoSenseAreRefusedWithWhatIsAccepted) {
  for (const char* text :
       {"", ",", "1,", "a", "1-", "1-2-3", "5-1", "1-5x0", "1-5x", "1000000", "1-5x-1", " 1", "1.5"})
    try {
      parse_frames(text);
      ADD_FAILURE() << "'" << text << "' was taken";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_usage);
      EXPECT_THAT(e.what(), HasSubstr("1-100x2")) << text;
    }
}

TEST(Frames, BeyondAHundredThousandAreRefusedWithThatNumber) {
  EXPECT_EQ(parse_frames("0-99999").size(), 100'000u);
  EXPECT_EQ(parse_frames("0-999999x10").size(), 100'000u);
  for (const char* text : {"0-100000", "0-99999,-5", "0-999999", "-999999-999999"}) try {
      parse_frames(text);
      ADD_FAILURE() << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_usage);
      EXPECT_THAT(e.what(), HasSubstr("accepted: at most 100000 frames")) << text;
    }
}

TEST(Patterns, HaveOnePlaceForANumber) {
  for (const char* name : {"a.####.exr", "a.#.exr", "#", "x%04d.exr", "x%d.exr"})
    EXPECT_TRUE(is_pattern(name)) << name;
  for (const char* name :
       {"a.exr", "a.#.#.exr", "a%4d.exr", "a%s.exr", "a%04d#.exr", "100%.exr", "a%0", "folder#/a.exr"})
    EXPECT_FALSE(is_pattern(name)) << name;
}

TEST(Patterns, GiveAFrameItsFile) {
  EXPECT_EQ(file_of("out/a.####.exr", 7), "out/a.0007.exr");
  EXPECT_EQ(file_of("a.##.exr", 12345), "a.12345.exr");
  EXPECT_EQ(file_of("a.%03d.exr", 42), "a.042.exr");
  EXPECT_EQ(file_of("a.%d.exr", 42), "a.42.exr");
  EXPECT_EQ(file_of("a.###.exr", -4), "a.-004.exr");
}

TEST(Patterns, FindTheFramesThatAreThere) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "frames_there";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  for (const char* name :
       {"a.0002.exr", "a.0010.exr", "a.-0001.exr", "a.3.exr", "a.00011.exr", "b.0004.exr", "a.0005.png"})
    std::ofstream(folder / name) << "x";
  EXPECT_THAT(frames_there(folder / "a.####.exr"), ElementsAre(-1, 2, 10));
  EXPECT_THAT(frames_there(folder / "c.####.exr"), ElementsAre());
  EXPECT_THROW(frames_there(folder / "no such folder" / "a.#.exr"), Error);
}

TEST(Frames, AreToldAsRanges) {
  EXPECT_EQ(ranges_of({}), "");
  EXPECT_EQ(ranges_of({-3}), "-3");
  EXPECT_EQ(ranges_of({1, 2, 3, 7, 9, 10}), "1-3, 7, 9-10");
}

}  // namespace
}  // namespace tessera
