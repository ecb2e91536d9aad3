// SPDX-License-Identifier: Apache-2.0
// `tessera denoise` on shots, by filters with history: files in, files out.
#include <gmock/gmock.h>

#include <fstream>
#include <limits>

#include "cli/frame_store.h"
#include "tests/cli/denoise_shot.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST_F(DenoiseShot, GoesByTheFramesBefore) {
  write_shot({1, 2, 3, 4});
  EXPECT_EQ(run(shot("out")), 0);
  EXPECT_THAT(problems_, IsEmpty());
  EXPECT_TRUE(same_bits(rgb("out", 1), single(1))) << "nothing comes before it";
  EXPECT_LT(noise_of(rgb("out", 4)), 0.75 * noise_of(single(4)));
  EXPECT_THAT(problems_, HasSubstr("a single image: history=on makes no difference"));
}

TEST_F(DenoiseShot, IsTheSameInAnyOrderAndInAnyTiles) {
  write_shot({1, 2, 3});
  EXPECT_EQ(run(shot("out")), 0);
  DenoiseOptions backwards = shot("back"), tiles = shot("tiles");
  backwards.frames = "3,2,1";
  tiles.tile_size = "7x9";
  EXPECT_EQ(run(backwards), 0);
  EXPECT_EQ(run(tiles), 0);
  for (const int f : {1, 2, 3}) {
    EXPECT_TRUE(same_bits(rgb("back", f), rgb("out", f))) << f;
    EXPECT_TRUE(same_bits(rgb("tiles", f), rgb("out", f))) << f;
  }
}

TEST_F(DenoiseShot, StartsAnewBehindAGapAFailureAndAnotherSize) {
  write_shot({1, 3, 5});
  std::ofstream(path(name("in", 4))) << "no EXR";
  write(name("in", 6), picture(6, {0, 0, 32, 24}));
  EXPECT_EQ(run(shot("out")), static_cast<int>(ExitCode::bad_input));
  EXPECT_THAT(problems_, HasSubstr("frame 3 starts anew: frame 2 was not filtered"));
  EXPECT_THAT(problems_, HasSubstr("frame 5 starts anew: frame 4 failed"));
  EXPECT_THAT(problems_, HasSubstr("frame 6 starts anew: frame 5 covers other pixels"));
  EXPECT_FALSE(there("out", 4));
  for (const int f : {3, 5, 6}) EXPECT_TRUE(same_bits(rgb("out", f), single(f))) << f;
}

TEST_F(DenoiseShot, StartsAnewAtACutThatItIsToldInEitherDirection) {
  write_shot({1, 2, 3, 4});
  DenoiseOptions o = shot("out");
  o.cuts = "3";
  EXPECT_EQ(run(o), 0);
  EXPECT_THAT(problems_, HasSubstr("frame 3 starts anew: there is a cut before frame 3"));
  EXPECT_TRUE(same_bits(rgb("out", 3), single(3)));
  EXPECT_FALSE(same_bits(rgb("out", 4), single(4)));
  o.both_ways = true;
  EXPECT_EQ(run(o), 0);
  EXPECT_THAT(problems_, HasSubstr("frame 2 starts anew, backwards: there is a cut before frame 3"));
  o = shot("out");
  o.cuts = "x";
  EXPECT_EQ(error_of(o).code(), ExitCode::bad_usage);
}

TEST_F(DenoiseShot, ReadsHandlesForTheirHistoryAndDoesNotWriteThem) {
  write_shot({2, 3, 4, 5});
  EXPECT_EQ(run(shot("out")), 0);
  DenoiseOptions some = shot("some");
  some.frames = "4";
  some.handles = 2;
  EXPECT_EQ(run(some), 0);
  EXPECT_TRUE(same_bits(rgb("some", 4), rgb("out", 4)));
  for (const int f : {2, 3, 5}) EXPECT_FALSE(there("some", f)) << f;
  some.handles = 1;
  EXPECT_EQ(run(some), 0);
  EXPECT_FALSE(same_bits(rgb("some", 4), rgb("out", 4))) << "frame 2 is missing from its history";
  std::ofstream(path(name("in", 3))) << "no EXR";
  EXPECT_EQ(run(some), 0) << "nothing that was asked for is missing";
  EXPECT_THAT(problems_, HasSubstr("frame 3: "));
  EXPECT_TRUE(same_bits(rgb("some", 4), single(4)));
}

TEST_F(DenoiseShot, RefusesFramesWithoutMotionUnlessNothingMoves) {
  for (const int f : {1, 2}) {
    ExrImage image = picture(f);
    for (ExrChannel& c : image.channels)
      if (c.name.starts_with("motion.")) c.name = "was_" + c.name;
    write(name("in", f), image);
  }
  EXPECT_EQ(run(shot("out")), static_cast<int>(ExitCode::bad_input));
  EXPECT_THAT(problems_, HasSubstr("--static"));
  DenoiseOptions still = shot("still");
  still.resting = true;
  EXPECT_EQ(run(still), 0);
  EXPECT_LT(noise_of(rgb("still", 2)), 0.9 * noise_of(single(2)));
}

TEST_F(DenoiseShot, LetsPixelsOfBrokenMotionStartAnewAndSaysHowMany) {
  write_shot({1, 2});
  ExrImage broken = picture(2);
  for (float& v : broken.pixels.plane(broken.plane("motion.X"))) v = std::numeric_limits<float>::quiet_NaN();
  write(name("in", 2), broken);
  EXPECT_EQ(run(shot("out")), 0);
  EXPECT_THAT(problems_, HasSubstr("motion: 960 of 960 pixels lead nowhere, the first at (0, 0)"));
  EXPECT_TRUE(same_bits(rgb("out", 2), single(2)));
}

TEST_F(DenoiseShot, BothWaysIsTheSameShotWhenTimeIsTurnedAround) {
  constexpr int kFrames = 5;
  write_shot({1, 2, 3, 4, 5});
  DenoiseOptions both = shot("out");
  both.both_ways = true;
  EXPECT_EQ(run(both), 0);
  EXPECT_THAT(problems_, IsEmpty());
  std::vector<Image> results;
  for (int f = 1; f <= kFrames; ++f) results.push_back(rgb("out", f));
  for (int f = 1; f <= kFrames; ++f) {
    ExrImage turned = picture(kFrames + 1 - f);
    for (const char* x : {"motion.X", "next_motion.X"})
      for (float& v : turned.pixels.plane(turned.plane(x))) v = -v;
    write(name("in", f), turned);
  }
  EXPECT_EQ(run(both), 0);
  for (int f = 1; f <= kFrames; ++f)
    EXPECT_LT(difference(rgb("out", f), results[static_cast<std::size_t>(kFrames - f)]), 1e-6) << f;
}

TEST_F(DenoiseShot, BothWaysHasLessNoiseAndLeavesNothingBehind) {
  write_shot({1, 2, 3, 4, 5});
  EXPECT_EQ(run(shot("out")), 0);
  DenoiseOptions both = shot("both"), one = shot("one");
  both.both_ways = one.both_ways = true;
  EXPECT_EQ(run(both), 0);
  for (const int f : {1, 2, 3}) EXPECT_LT(noise_of(rgb("both", f)), 0.9 * noise_of(rgb("out", f))) << f;
  EXPECT_LT(noise_of(rgb("both", 5)), 0.9 * noise_of(single(5))) << "nothing follows it";
  one.frames = "3";
  EXPECT_EQ(run(one), 0);
  EXPECT_LT(difference(rgb("one", 3), single(3)), 1e-6) << "nothing comes before and nothing follows";
  one.handles = 2;
  EXPECT_EQ(run(one), 0);
  EXPECT_TRUE(same_bits(rgb("one", 3), rgb("both", 3)));
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_THAT(entry.path().extension().string(), testing::AnyOf(".exr", ".png")) << entry.path();
}

TEST_F(DenoiseShot, BothWaysGoesOnOnBothSidesOfAFrameThatFails) {
  write_shot({1, 2, 4, 5});
  std::ofstream(path(name("in", 3))) << "no EXR";
  DenoiseOptions both = shot("out");
  both.both_ways = true;
  EXPECT_EQ(run(both), static_cast<int>(ExitCode::bad_input));
  EXPECT_EQ(problems_.find("frame 3: "), problems_.rfind("frame 3: ")) << "said once";
  EXPECT_THAT(problems_, HasSubstr("frame 2 starts anew, backwards: frame 3 failed"));
  EXPECT_THAT(problems_, HasSubstr("frame 4 starts anew: frame 3 failed"));
  for (const int f : {1, 2, 4, 5}) EXPECT_LT(noise_of(rgb("out", f)), 0.9 * noise_of(single(f))) << f;
}

TEST_F(DenoiseShot, RefusesBothWaysAndHandlesWhereTheyMeanNothing) {
  write_shot({1, 2});
  DenoiseOptions o = shot("out");
  o.both_ways = true;
  o.filter = "svgf";
  EXPECT_THAT(error_of(o).what(), HasSubstr("--both-ways"));
  EXPECT_EQ(error_of(o).code(), ExitCode::bad_usage);
  o = options(name("in", 1), "out.exr");
  o.handles = 3;
  EXPECT_THAT(error_of(o).what(), HasSubstr("--handles: '3'"));
  o = shot("out");
  o.motion_scale = "1";
  EXPECT_THAT(error_of(o).what(), HasSubstr("X,Y"));
  o = shot("out");
  o.both_ways = true;
  for (const int f : {1, 2}) {
    ExrImage image = picture(f);
    for (ExrChannel& c : image.channels)
      if (c.name.starts_with("next_motion.")) c.name = "was_" + c.name;
    write(name("in", f), image);
  }
  EXPECT_EQ(run(o), static_cast<int>(ExitCode::bad_input));
  EXPECT_THAT(problems_, HasSubstr("next_motion.XY (or Vector.ZW"));
  EXPECT_FALSE(there("out", 1));
}

TEST(FrameStore, GivesBackWhatWasPutAside) {
  const fs::path folder =
      fs::path(testing::TempDir()) / ("tessera-store" + std::to_string(std::random_device{}()));
  EXPECT_THROW(FrameStore{folder}, InputError);
  fs::create_directories(folder);
  {
    FrameStore store(folder);
    Image first({0, 0, 3, 2}, 4), second({-1, 5, 4, 6}, 1);
    float next = 0;
    for (Image* image : {&first, &second})
      for (float& v : image->data()) v = ++next;
    store.put(7, first);
    store.put(-3, second);
    EXPECT_TRUE(same_bits(store.get(-3), second));
    EXPECT_TRUE(same_bits(store.get(7), first));
    EXPECT_TRUE(store.get(1).empty());
    EXPECT_TRUE(fs::is_empty(folder)) << "it has no name there";
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace tessera
