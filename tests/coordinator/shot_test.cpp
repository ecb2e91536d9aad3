// SPDX-License-Identifier: Apache-2.0
#include "coordinator/shot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/resume.h"
#include "core/error.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<Job> frames(const std::vector<int>& numbers, const char* filter = "svgf:history=on") {
  std::vector<Job> jobs;
  for (const int n : numbers) {
    Job& job = jobs.emplace_back();
    job.frame = n;
    job.filter = parse_filter(filter);
  }
  return jobs;
}

std::shared_ptr<const Image> something() { return std::make_shared<const Image>(Region{0, 0, 1, 1}, 1); }

TEST(Continues, OnlyTheNextFrameOfTheSameViewWithATemporalFilter) {
  const auto two = frames({4, 5});
  EXPECT_TRUE(continues(two[0], two[1]));
  EXPECT_FALSE(continues(two[1], two[0]));
  EXPECT_FALSE(continues(two[0], two[0]));
  const auto apart = frames({4, 6});
  EXPECT_FALSE(continues(apart[0], apart[1]));
  const auto single = frames({4, 5}, "svgf");
  EXPECT_FALSE(continues(single[0], single[1]));
  const auto with = [&](auto&& change) {
    Job next = two[1];
    change(next);
    return continues(two[0], next);
  };
  EXPECT_FALSE(with([](Job& j) { j.cut = true; }));
  EXPECT_FALSE(with([](Job& j) { j.render.camera = "other"; })) << "a cut";
  EXPECT_FALSE(with([](Job& j) { j.render.size.width += 1; }));
  EXPECT_FALSE(with([](Job& j) { j.crop = Region{0, 0, 9, 9}; }));
  EXPECT_FALSE(with([](Job& j) { j.scene.hash = "other"; }));
  EXPECT_FALSE(with([](Job& j) { j.filter = parse_filter("atrous:history=on"); }));
  EXPECT_TRUE(with([](Job& j) { j.render.seed = 9; }));
}

TEST(Continues, AFrameThatIsGivenWhereItIsSaidToAndBothAreOfTheSamePixels) {
  auto two = frames({5, 4});
  for (Job& job : two) {
    job.given = Given{.planes = sha256("a"), .display = {0, 0, 8, 8}, .goes_on = true};
    job.crop = Region{0, 0, 8, 8};
  }
  EXPECT_TRUE(continues(two[0], two[1])) << "backwards in time";
  const auto with = [&](auto&& change) {
    Job next = two[1];
    change(next);
    return continues(two[0], next);
  };
  EXPECT_FALSE(with([](Job& j) { j.given->goes_on = false; }));
  EXPECT_FALSE(with([](Job& j) { j.crop = Region{0, 0, 8, 7}; }));
  EXPECT_FALSE(with([](Job& j) { j.filter = parse_filter("svgf"); }));
  EXPECT_FALSE(with([](Job& j) { j.given.reset(); }));
  const auto keys = image_keys(two);
  EXPECT_NE(keys[0], keys[1]);
  two[0].given->planes = sha256("b");
  EXPECT_NE(image_keys(two)[1], keys[1]) << "what comes before it is another frame";
  two[1].given->goes_on = false;
  EXPECT_EQ(image_key(two[1], ""), image_keys(two)[1]);
}

TEST(ShotPlan, TwoFramesAreUnderWayAndTheSecondWaitsForWhatTheFirstKeeps) {
  ShotPlan plan({frames({1, 2, 3})});
  const auto first = plan.start(), second = plan.start();
  ASSERT_TRUE(first && second);
  EXPECT_FALSE(plan.start()) << "two are enough";
  EXPECT_FALSE(first->awaits_history);
  EXPECT_EQ(first->history, nullptr);
  EXPECT_TRUE(second->awaits_history);
  EXPECT_EQ(plan.end(0, something()), 1u);
  const auto third = plan.start();
  ASSERT_TRUE(third);
  EXPECT_TRUE(third->awaits_history);
  EXPECT_EQ(plan.end(1, something()), 2u);
  EXPECT_FALSE(plan.over());
  EXPECT_EQ(plan.end(2, something()), std::nullopt);
  EXPECT_TRUE(plan.over());
  EXPECT_EQ(plan.done(), 3);
}

TEST(ShotPlan, AFrameThatBeginsLaterFindsWhatWasKept) {
  Shot shot{frames({1, 2})};
  shot.in_flight = 1;
  ShotPlan plan(shot);
  plan.start();
  const auto kept = something();
  EXPECT_EQ(plan.end(0, kept), std::nullopt);
  const auto second = plan.start();
  ASSERT_TRUE(second);
  EXPECT_FALSE(second->awaits_history);
  EXPECT_EQ(second->history, kept);
}

TEST(ShotPlan, AFrameAfterACutAwaitsNothing) {
  ShotPlan plan({frames({1, 5})});
  plan.start();
  EXPECT_FALSE(plan.start()->awaits_history);
  EXPECT_EQ(plan.end(0, something()), std::nullopt);
}

TEST(ShotPlan, AFrameThatFailedLeavesTheNextOneToStartAnew) {
  ShotPlan plan({frames({1, 2})});
  plan.start(), plan.start();
  EXPECT_EQ(plan.end(0, nullptr), 1u) << "it is told, and waits no longer";
}

TEST(ShotPlan, StoppedItBeginsNoMore) {
  ShotPlan plan({frames({1, 2, 3})});
  plan.start();
  plan.stop();
  EXPECT_FALSE(plan.start());
  plan.end(0, nullptr);
  EXPECT_TRUE(plan.over());
}

TEST(ShotPlan, GivenHistoryGoesToTheFrameItIsFor) {
  Shot shot{frames({4, 9, 10})};
  const auto kept = something();
  shot.histories[1] = kept;
  ShotPlan plan(shot);
  EXPECT_EQ(plan.start()->history, nullptr);
  const auto second = plan.start();
  EXPECT_EQ(second->history, kept);
  EXPECT_FALSE(second->awaits_history);
}

TEST(Shot, WithoutFramesIsRefused) { EXPECT_THROW(validate(Shot{}), InputError); }

TEST(ImageKey, TellsApartWhatDecidesTheImageAndNothingElse) {
  const Job job = frames({1})[0];
  const std::string key = image_key(job, "");
  EXPECT_EQ(key.size(), 64u);
  const auto same = [&](auto&& change, const char* before = "") {
    Job other = job;
    change(other);
    return image_key(other, before) == key;
  };
  EXPECT_TRUE(same([](Job& j) { j.tile = {37, 53}; }));
  EXPECT_TRUE(same([](Job& j) { j.task_samples /= 2; }));
  EXPECT_TRUE(same([](Job& j) { j.scene.path = "elsewhere"; }));
  EXPECT_TRUE(same([](Job& j) { j.crop = j.region(); })) << "a crop of all";
  EXPECT_FALSE(same([](Job&) {}, "another frame"));
  EXPECT_FALSE(same([](Job& j) { j.frame = 2; }));
  EXPECT_FALSE(same([](Job& j) { j.scene.hash = "x"; }));
  EXPECT_FALSE(same([](Job& j) { j.render.seed = 1; }));
  EXPECT_FALSE(same([](Job& j) { j.render.max_bounces = 1; }));
  EXPECT_FALSE(same([](Job& j) { j.render.clamp_direct = 1; }));
  EXPECT_FALSE(same([](Job& j) { j.render.variant = "x"; }));
  EXPECT_FALSE(same([](Job& j) { j.render.aovs = AovSet::all(); }));
  EXPECT_FALSE(same([](Job& j) { j.acceptance.relmse = 0.5; }));
  EXPECT_FALSE(same([](Job& j) { j.filter.parameters["sigma_l"] = 3; }));
  EXPECT_FALSE(same([](Job& j) { j.crop = Region{0, 0, 9, 9}; }));
}

TEST(ImageKeys, OfFramesThatGoOnDependOnAllThatLeadUpToThem) {
  auto shot = frames({1, 2, 3, 7});
  const auto keys = image_keys(shot);
  shot[0].render.seed = 1;
  const auto others = image_keys(shot);
  EXPECT_NE(keys[2], others[2]);
  EXPECT_EQ(keys[3], others[3]) << "after a cut";
  const auto later = image_keys(frames({2, 3}));
  EXPECT_NE(keys[2], later[1]) << "the same frame of a shot that begins later";
}

TEST(KeyAsMade, BehindAFrameThatFailedIsThatOfAShotThatBeginsThere) {
  const auto shot = frames({1, 2, 3, 4, 5});
  const auto meant = image_keys(shot);
  auto keys = meant;
  for (const std::size_t i : {0u, 1u, 3u, 4u})  // the third has failed
    keys[i] = key_as_made(shot, keys, i, i != 0 && i != 3);
  EXPECT_EQ(keys[1], meant[1]);
  const auto anew = image_keys(frames({4, 5}));
  EXPECT_EQ(keys[3], anew[0]);
  EXPECT_EQ(keys[4], anew[1]) << "its history is another, too";
  EXPECT_NE(keys[4], meant[4]);
  std::vector<bool> done;
  for (std::size_t i = 0; i < shot.size(); ++i) done.push_back(i != 2 && keys[i] == meant[i]);
  EXPECT_THAT(remaining(shot, meant, done, meant[1]).frames, ElementsAre(2, 3, 4));
}

std::vector<std::size_t> left(const std::vector<Job>& jobs, std::vector<bool> done, int kept = -1) {
  const auto keys = image_keys(jobs);
  return remaining(jobs, keys, done, kept < 0 ? "" : keys[static_cast<std::size_t>(kept)]).frames;
}

TEST(Remaining, FramesThatStandAloneAreDoneWhereTheyAreMissing) {
  const auto jobs = frames({1, 2, 3, 4}, "svgf");
  EXPECT_THAT(left(jobs, {true, false, true, false}), ElementsAre(1, 3));
  EXPECT_THAT(left(jobs, {true, true, true, true}), IsEmpty());
}

TEST(Remaining, AFrameWhoseHistoryIsGoneTakesThoseBeforeItAlong) {
  const auto jobs = frames({1, 2, 3, 4});
  EXPECT_THAT(left(jobs, {true, true, false, false}), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(left(jobs, {true, true, false, false}, 1), ElementsAre(2, 3));
  EXPECT_THAT(left(jobs, {true, true, false, false}, 0), ElementsAre(1, 2, 3)) << "killed between two files";
  EXPECT_THAT(left(jobs, {true, true, true, true}), IsEmpty());
  EXPECT_THAT(left(jobs, {false, true, true, true}), ElementsAre(0))
      << "those behind it are as they should be";
}

TEST(Remaining, ACutEndsWhatIsTakenAlong) {
  EXPECT_THAT(left(frames({1, 2, 5, 6}), {true, true, true, false}), ElementsAre(2, 3));
}

TEST(Remaining, SaysWhichFramesGoByWhatIsInTheFile) {
  const auto jobs = frames({1, 2, 3, 4});
  const auto keys = image_keys(jobs);
  EXPECT_THAT(remaining(jobs, keys, {false, true, false, false}, keys[1]).from_kept, ElementsAre(2));
  EXPECT_THAT(remaining(jobs, keys, {false, true, false, false}, "another shot's").from_kept, IsEmpty());
}

}  // namespace
}  // namespace tessera
