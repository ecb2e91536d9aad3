// SPDX-License-Identifier: Apache-2.0
// The farm filters frames that it is given, to the bits of a filter that sees them whole.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <random>

#include "core/filter/given.h"
#include "tests/farm/service.h"
#include "worker/denoise/runner.h"

namespace tessera::farm {
namespace {

using testing::HasSubstr;

constexpr Region kPicture{0, 0, 70, 50};
constexpr Region kOverscan{-6, -5, 75, 53};  // odd, and more than the picture

Image noise(const FilterPlan& plan, const Region& region, unsigned seed) {
  const std::vector<Channel> channels = plan.inputs();
  Image planes(region, static_cast<int>(channels.size()));
  std::minstd_rand random(seed);
  std::uniform_real_distribution<float> chance(0.1f, 1.0f);
  for (std::size_t k = 0; k < channels.size(); ++k)
    for (float& v : planes.plane(static_cast<int>(k)))
      v = channels[k].aov == Aov::motion ? 1.5f : channels[k].aov == Aov::object_id ? 1.0f : chance(random);
  return planes;
}

// What `tessera denoise` makes of it: one tile, which is the frame.
Image filtered_whole(const FilterPlan& plan, const Image& planes, const Image& history = {}) {
  static const auto device = Device::open("");
  const Region& frame = planes.region();
  return filter(*device, plan, planes, {frame, frame}, frame, history);
}

class GivenFrames : public Service {
 protected:
  struct Frame {
    int number = 0;
    Image planes;
    bool goes_on = false;
  };
  Digest put(const FilterPlan& plan, const Image& planes) {
    return farm().store().blobs().put(exr_bytes(given_file(plan, planes, kPicture), "none"));
  }
  Submission submission_of(const std::string& filter, const std::vector<Frame>& frames,
                           Size tile = {32, 20}) {
    Submission s{.name = "given"};
    s.job.filter = parse_filter(filter);
    s.job.tile = tile;
    for (const Frame& f : frames) {
      s.frames.push_back(f.number);
      s.given.push_back({{put(s.job.filter, f.planes), kPicture, f.goes_on}, f.planes.region(), 0, 0});
    }
    return s;
  }
  Reply hand_in(const JobName& name, const Submission& s) {
    return ask(Submit{name, farm().store().blobs().put(encode(s))});
  }
  ExrImage file_of(const JobName& name, std::uint32_t place) {
    const FrameSummary frame = frames(name).at(place);
    return read_exr(farm().store().blobs().path(frame.image));
  }
  std::vector<FrameSummary> frames(const JobName& name) {
    return std::get<JobDetail>(ask(ShowJob{name})).frames;
  }
  Image rgb_of(const JobName& name, std::uint32_t place) {
    const ExrImage file = file_of(name, place);
    EXPECT_EQ(file.display, kPicture);
    Image rgb(file.pixels.region(), 3);
    for (int c = 0; c < 3; ++c) {
      const int plane = file.plane(std::string(1, "RGB"[c]));
      EXPECT_EQ(file.channels.at(static_cast<std::size_t>(plane)).type, ExrType::float32);
      std::ranges::copy(file.pixels.plane(plane), rgb.plane(c).begin());
    }
    return rgb;
  }
  void damage(const Digest& blob) {
    const fs::path file = farm().store().blobs().path(blob);
    fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(-5, std::ios::end) << "XXXX";
  }
};

TEST_F(GivenFrames, AreTheBitsOfTheWholeFrameInWhateverTilesByTwoWorkers) {
  farm();
  hire(2, runner());
  for (const char* filter : {"atrous:levels=2", "svgf:levels=2", "nlm", "none"}) {
    const FilterPlan plan = parse_filter(filter);
    const Image planes = noise(plan, kOverscan, 7), whole = filtered_whole(plan, planes);
    for (const Size tile : {Size{32, 20}, {7, 48}, {500, 500}}) {
      const JobName name = fmt::format("{}.{}", plan.name, tile.width);
      ASSERT_TRUE(std::holds_alternative<Agreed>(hand_in(name, submission_of(filter, {{3, planes}}, tile))));
      ASSERT_TRUE(comes_to(name, JobState::completed)) << events(name);
      EXPECT_TRUE(same_bits(rgb_of(name, 0), planes_of(whole, 0, 3))) << name;
      EXPECT_THAT(events(name), HasSubstr("frame 3: filtered"));
      EXPECT_EQ(*file_of(name, 0).about<int>("tessera/frame"), 3);
    }
  }
}

constexpr const char* kShot = "svgf:levels=1,history=on";

TEST_F(GivenFrames, GoByWhatTheOneBeforeKeepsWhereTheyAreSaidTo) {
  farm();
  hire(2, runner());
  const FilterPlan plan = parse_filter(kShot);
  std::vector<Frame> shot;
  for (const int number : {9, 8, 7}) shot.push_back({number, noise(plan, kOverscan, number), number != 9});
  shot.push_back({6, noise(plan, kOverscan, 6), false});
  hand_in("shot", submission_of(kShot, shot));
  ASSERT_TRUE(comes_to("shot", JobState::completed)) << events("shot");
  Image history;
  for (std::uint32_t i = 0; i < shot.size(); ++i) {
    const Image whole = filtered_whole(plan, shot[i].planes, shot[i].goes_on ? history : Image{});
    EXPECT_TRUE(same_bits(rgb_of("shot", i), planes_of(whole, 0, 3))) << i;
    history = planes_of(whole, 3, plan.history());
  }
}

TEST_F(GivenFrames, OneThatIsDamagedFailsAndIsACutAndTheOthersAreDone) {
  const FilterPlan plan = parse_filter(kShot);
  std::vector<Frame> shot;
  for (const int number : {1, 2, 3, 4}) shot.push_back({number, noise(plan, kPicture, number), number != 1});
  const Submission s = submission_of(kShot, shot);
  hand_in("shot", s);
  damage(s.given[1].given.planes);
  hire(2, runner());
  ASSERT_TRUE(comes_to("shot", JobState::failed)) << events("shot");
  EXPECT_THAT(job("shot").reason, HasSubstr("1 of 4 frames failed"));
  EXPECT_EQ(frames("shot").at(1).state, FrameState::failed);
  EXPECT_THAT(frames("shot").at(1).reason, HasSubstr(s.given[1].given.planes));
  const Image third = filtered_whole(plan, shot[2].planes);
  EXPECT_TRUE(same_bits(rgb_of("shot", 2), planes_of(third, 0, 3)));
  const Image fourth = filtered_whole(plan, shot[3].planes, planes_of(third, 3, plan.history()));
  EXPECT_TRUE(same_bits(rgb_of("shot", 3), planes_of(fourth, 0, 3)));
}

TEST_F(GivenFrames, WhatAFilterDoesNotTakeFailsWithTheReason) {
  farm();
  hire(1, runner());
  const FilterPlan nlm = parse_filter("nlm");
  const Image planes = noise(nlm, kPicture, 1);
  const auto reason_of = [&](const JobName& name, const auto& spoil) {
    Submission s = submission_of("nlm", {{0, planes}, {1, planes}});
    spoil(s);
    EXPECT_TRUE(std::holds_alternative<Agreed>(hand_in(name, s)));
    EXPECT_TRUE(comes_to(name, JobState::failed)) << events(name);
    EXPECT_EQ(frames(name).at(1).state, FrameState::completed);
    return frames(name).at(0).reason;
  };
  BlobStore& blobs = farm().store().blobs();
  EXPECT_THAT(reason_of("text", [&](Submission& s) { s.given[0].given.planes = blobs.put("no EXR"); }),
              HasSubstr("complete OpenEXR file"));
  const Digest other = put(parse_filter("none"), noise(parse_filter("none"), kPicture, 1));
  EXPECT_THAT(reason_of("other", [&](Submission& s) { s.given[0].given.planes = other; }),
              HasSubstr("has no channel"));
  EXPECT_THAT(reason_of("smaller", [&](Submission& s) { s.given[0].region.x1 -= 1; }),
              testing::AnyOf(HasSubstr("covers the pixels 0 0 to 70 50"), HasSubstr("values; accepted")));
}

TEST_F(GivenFrames, GoOnInAnotherLifeWithTheSameBits) {
  const FilterPlan plan = parse_filter(kShot);
  std::vector<Frame> shot;
  for (const int number : {1, 2}) shot.push_back({number, noise(plan, kPicture, number), number != 1});
  hand_in("undisturbed", submission_of(kShot, shot, {16, 16}));
  hand_in("disturbed", submission_of(kShot, shot, {16, 16}));
  hire(2, runner());
  ASSERT_TRUE(comes_to("undisturbed", JobState::completed)) << events("undisturbed");
  int lives = 0;
  ASSERT_NO_FATAL_FAILURE(disturb("disturbed", lives));
  EXPECT_GT(lives, 2);
  for (const std::uint32_t place : {0u, 1u})
    EXPECT_TRUE(same_bits(rgb_of("disturbed", place), rgb_of("undisturbed", place)));
}

TEST_F(GivenFrames, AreRefusedWhereTheirBlobsAreNotThereOrTheyTakeTooMuch) {
  const FilterPlan plan = parse_filter("nlm");
  const Image planes = noise(plan, kPicture, 1);
  Submission missing = submission_of("nlm", {{0, planes}});
  missing.given[0].given.planes = sha256("nothing");
  EXPECT_THAT(std::get<Denied>(hand_in("missing", missing)).reason, HasSubstr("is not here"));
  Submission big = submission_of("nlm", {{0, planes}, {1, planes}});
  big.given[1].region = {0, 0, 8000, 8000};
  EXPECT_EQ(std::get<Denied>(hand_in("big", big)).code, ExitCode::out_of_memory);
  Submission modest = submission_of("nlm", {{0, planes}});
  modest.limits.bytes = 70 * 50 * 4;
  EXPECT_EQ(std::get<Denied>(hand_in("modest", modest)).code, ExitCode::out_of_memory);
}

TEST_F(GivenFrames, EndAtTheJobsLimitWithThePictureAsFarAsItIsFiltered) {
  const FilterPlan plan = parse_filter("none");
  const Image planes = noise(plan, kPicture, 1);
  Submission s = submission_of("none", {{0, planes}});
  s.limits.seconds = 0.01;
  hand_in("limited", s);  // there is no worker
  ASSERT_TRUE(comes_to("limited", JobState::failed)) << events("limited");
  EXPECT_EQ(frames("limited").at(0).state, FrameState::limited);
  EXPECT_THAT(events("limited"), HasSubstr("not all tiles are filtered"));
  EXPECT_TRUE(same_bits(rgb_of("limited", 0), planes));
}

TEST_F(GivenFrames, AreNotVerifiedWhichIsSaid) {
  farm();
  hire(1, runner());
  hand_in("one", submission_of("none", {{0, noise(parse_filter("none"), kPicture, 1)}}));
  ASSERT_TRUE(comes_to("one", JobState::completed)) << events("one");
  EXPECT_THAT(std::get<Denied>(ask(Control{"one", Verb::verify, 3})).reason,
              HasSubstr("filters what it was given"));
}

TEST_F(GivenFrames, ArePausedAndCancelled) {
  const FilterPlan plan = parse_filter("none");
  const Submission s = submission_of("none", {{0, noise(plan, kPicture, 1)}});
  hand_in("paused", s);
  hand_in("unwanted", s);
  hand_in("other", s);
  ask(Control{"paused", Verb::pause});
  ask(Control{"unwanted", Verb::cancel});
  hire(1, runner());
  ASSERT_TRUE(comes_to("other", JobState::completed)) << events("other");
  EXPECT_EQ(job("paused").state, JobState::paused);
  EXPECT_EQ(job("unwanted").state, JobState::cancelled);
  ask(Control{"paused", Verb::resume});
  EXPECT_TRUE(comes_to("paused", JobState::completed));
}

}  // namespace
}  // namespace tessera::farm
