// SPDX-License-Identifier: Apache-2.0
#include "coordinator/given_frame.h"

#include <gmock/gmock.h>

#include <random>

#include "core/error.h"
#include "tests/coordinator/made_up_frame.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

// Does all of this work, in an order of chance.
void do_all(GivenFrame& frame, std::vector<Work> work, unsigned seed) {
  std::mt19937 random(seed);
  std::shuffle(work.begin(), work.end(), random);
  for (const Work& w : work) {
    const FilterTask& task = std::get<FilterTask>(w);
    const Filtered answer = filtered_given(task, frame.filter_input(task), frame.job());
    EXPECT_TRUE(frame.fits(task, answer));
    frame.stitch(task, answer);
    frame.stitch(task, answer);
  }
}

FrameImage worked_off(GivenFrame& frame, unsigned seed) {
  do_all(frame, frame.begin(), seed);
  EXPECT_TRUE(frame.round_complete());
  EXPECT_THAT(frame.look({}), IsEmpty());
  return frame.image();
}

TEST(GivenFrame, IsFilteredInOneRoundToTheSameBitsInWhateverTilesAndOrder) {
  Job job = given_job("nlm");
  const Planes planes = given_planes_of(job);
  for (const Size tile : {Size{32, 16}, {7, 11}, {1000, 1000}}) {
    job.tile = tile;
    GivenFrame frame(job, planes);
    const FrameImage image = worked_off(frame, 3);
    EXPECT_TRUE(same_bits(image.filtered, planes_of(*planes, 0, 3)));
    EXPECT_EQ(image.stop, StopReason::filtered);
    EXPECT_TRUE(image.sums.empty());
    EXPECT_EQ(frame.progress(1).fraction, 1);
  }
}

TEST(GivenFrame, ATaskTakesThePlanesOfItsOuterRegionWhoseHaloIsTheFilters) {
  const Job job = given_job("nlm");
  const Planes planes = given_planes_of(job);
  GivenFrame frame(job, planes);
  for (const Work& work : frame.begin()) {
    const Tile& tile = std::get<FilterTask>(work).tile;
    EXPECT_EQ(tile.outer, intersect(grown(tile.inner, job.filter.halo()), job.region()));
    const FilterInput input = frame.filter_input(std::get<FilterTask>(work));
    EXPECT_TRUE(same_bits(input.film, cropped(*planes, tile.outer)));
    EXPECT_TRUE(input.history.empty());
  }
}

TEST(GivenFrame, WaitsForItsHistoryAndTakesOfItWhatItsMotionTouches) {
  const Job job = given_job("svgf:history=on");
  const Planes planes = given_planes_of(job);
  GivenFrame frame(job, planes, true);
  EXPECT_THAT(frame.begin(), IsEmpty());
  EXPECT_THAT(frame.outstanding(), IsEmpty());
  const auto history = std::make_shared<const Image>(job.region(), job.filter.history(), 0.25f);
  const std::vector<Work> work = frame.remember(history);
  EXPECT_EQ(work.size(), plan_tiles(job).size());
  EXPECT_EQ(frame.outstanding().size(), work.size());
  const FilterTask& task = std::get<FilterTask>(work.front());
  const Region seen = frame.filter_input(task).history.region();
  EXPECT_TRUE(job.region().contains(seen));
  EXPECT_TRUE(seen.contains(intersect(grown(task.tile.outer, -2), job.region())));
  do_all(frame, work, 1);
  frame.look({});
  EXPECT_TRUE(frame.continued());
  const FilterTask whole{{job.region(), job.region()}, 1};
  const Filtered expected = filtered_given(whole, {*planes, *history}, job);
  EXPECT_TRUE(same_bits(*frame.kept(), planes_of(expected, 3, job.filter.history())));
  EXPECT_TRUE(same_bits(frame.image().filtered, planes_of(expected, 0, 3)));
}

TEST(GivenFrame, WhatIsNotFilteredYetIsShownAsItWasGiven) {
  const Job job = given_job("svgf");  // takes direct and indirect light and emission
  const Planes planes = given_planes_of(job);
  GivenFrame frame(job, planes);
  const std::vector<Work> work = frame.begin();
  const FilterTask& first = std::get<FilterTask>(work.front());
  frame.stitch(first, Filtered(first.tile.inner, 3, 7.0f));
  const Region& done = first.tile.inner;
  const Region& open = std::get<FilterTask>(work.back()).tile.inner;
  EXPECT_EQ(frame.preview().at(1, done.x0, done.y0), 7.0f);
  float light = 0;
  const std::vector<Channel> channels = job.filter.inputs();
  for (const Aov aov : {Aov::direct, Aov::indirect, Aov::emission})
    for (std::size_t k = 0; k < channels.size(); ++k)
      if (channels[k] == Channel{aov, 1}) light += planes->at(static_cast<int>(k), open.x0, open.y0);
  EXPECT_EQ(frame.preview().at(1, open.x0, open.y0), light);
  const Progress p = frame.progress(2);
  EXPECT_EQ(p.tiles_done, 1);
  EXPECT_EQ(p.tiles_round, static_cast<int>(work.size()));
  EXPECT_EQ(frame.outstanding().size() + 1, work.size());
  frame.stop(StopReason::interrupted);
  EXPECT_TRUE(same_bits(frame.image().filtered, frame.preview()));
  EXPECT_THAT(frame.outstanding(), IsEmpty());
}

TEST(GivenFrame, RefusesOtherPlanesAndOtherAnswersThanItsFilters) {
  const Job job = given_job("nlm");
  const auto with = [&](const Region& region, int planes) {
    return [=] { GivenFrame(job, std::make_shared<const Image>(region, planes)); };
  };
  const int taken = filter_shape(job).taken;
  EXPECT_NO_THROW(with(job.region(), taken)());
  EXPECT_THAT(with(job.region(), taken + 1), ThrowsMessage<InputError>(HasSubstr("other planes")));
  EXPECT_THAT(with(grown(job.region(), 1), taken), ThrowsMessage<InputError>(HasSubstr("other planes")));
  GivenFrame frame(job, given_planes_of(job));
  const FilterTask task = std::get<FilterTask>(frame.begin().front());
  EXPECT_FALSE(frame.fits(task, Filtered(task.tile.inner, 9)));
  EXPECT_FALSE(frame.fits(task, Filtered(task.tile.outer, 3)));
  EXPECT_FALSE(frame.fits(RenderTask{task.tile.inner, {0, 8}}, Block{{0, 8}, Image(task.tile.inner, 3)}));
  FrameSnapshot rendered;
  rendered.round = 2;
  EXPECT_THROW(GivenFrame(job, given_planes_of(job), rendered), InputError);
  EXPECT_EQ(make_frame(job, frame.snapshot(), given_planes_of(job))->round(), 1);
}

TEST(GivenFrame, WithoutPlanesThereIsNoWork) {
  GivenFrame frame(given_job("nlm"), nullptr);
  EXPECT_THAT(frame.begin(), IsEmpty());
  EXPECT_THAT(frame.outstanding(), IsEmpty());
  EXPECT_FALSE(frame.image().filtered.empty());
}

}  // namespace
}  // namespace tessera
