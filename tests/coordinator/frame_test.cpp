// SPDX-License-Identifier: Apache-2.0
#include "coordinator/rendered_frame.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>

#include "tests/coordinator/made_up_frame.h"

namespace tessera {
namespace {

Job small_job() {
  Job job;
  job.render.size = {150, 90};
  job.acceptance.relmse = 0.002;
  job.acceptance.max_samples = 256;
  job.task_samples = 1 << 14;
  return job;
}

// Works off a frame in an order drawn by `seed`; some results come twice.
FrameImage worked_off(const Job& job, unsigned seed, float noise = 0.6f) {
  std::mt19937 random(seed);
  RenderedFrame frame(job);
  std::deque<Work> todo;
  const auto add = [&](const std::vector<Work>& work) { todo.insert(todo.end(), work.begin(), work.end()); };
  add(frame.begin());
  while (!frame.stopped()) {
    EXPECT_FALSE(todo.empty()) << "a round without work that is not complete";
    std::swap(todo.front(), todo[random() % todo.size()]);
    const Work work = todo.front();
    todo.pop_front();
    for (unsigned copies = random() % 8 == 0 ? 2 : 1; copies > 0; --copies) {
      if (const auto* render = std::get_if<RenderTask>(&work))
        add(frame.fold(rendered(*render, frame.layout(), noise)));
      else
        frame.stitch(
            std::get<FilterTask>(work),
            filtered(std::get<FilterTask>(work), frame.filter_input(std::get<FilterTask>(work)), job));
    }
    if (frame.round_complete()) {
      EXPECT_TRUE(todo.empty()) << "a round that is complete leaves no work";
      add(frame.look({}));
    }
  }
  return frame.image();
}

TEST(Frame, IsTheSameBitsInWhateverOrderResultsComeAndHoweverItIsCut) {
  const FrameImage first = worked_off(small_job(), 1);
  EXPECT_EQ(first.stop, StopReason::accepted);
  for (unsigned seed = 2; seed < 8; ++seed) {
    Job job = small_job();
    job.tile = seed % 2 == 0 ? Size{37, 53} : Size{64, 200};
    job.task_samples = 1 << (8 + seed);
    const FrameImage other = worked_off(job, seed);
    EXPECT_TRUE(same_bits(first.filtered, other.filtered)) << "seed " << seed;
    EXPECT_TRUE(same_bits(first.sums, other.sums)) << "seed " << seed;
    EXPECT_EQ(first.states, other.states) << "seed " << seed;
  }
}

TEST(Frame, SaysThatItStoppedAtTheLimitWhenTheTargetCannotBeMet) {
  Job job = small_job();
  job.acceptance.relmse = 1e-7;
  job.acceptance.max_samples = 32;
  const FrameImage image = worked_off(job, 3);
  EXPECT_EQ(image.stop, StopReason::max_samples);
  EXPECT_EQ(image.pixel_samples, 150 * 90 * 32);
  EXPECT_EQ(image.acceptable_share, 0.0);
  EXPECT_GT(image.error.mean, 1e-7);
}

TEST(Frame, WithoutATargetEveryPixelGetsTheSamplesAskedForInOneRound) {
  Job job = small_job();
  job.acceptance.relmse.reset();
  job.acceptance.max_samples = 64;
  const FrameImage image = worked_off(job, 4);
  EXPECT_EQ(image.rounds, 1);
  EXPECT_EQ(image.pixel_samples, 150 * 90 * 64);
  EXPECT_EQ(image.stop, StopReason::max_samples);
}

TEST(Frame, TheEstimatedErrorIsThatOfTheImageWithinItsBound) {
  Job job = small_job();
  job.acceptance.relmse.reset();
  job.acceptance.max_samples = 32;
  const FrameImage image = worked_off(job, 5);
  Image truth = image.filtered;
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 150; ++x) truth.at(c, x, y) = 0.5f + 0.002f * static_cast<float>(x + y);
  const double error = rel_mse(image.filtered, truth);
  EXPECT_NEAR(image.error.mean, error, 4 * image.error.standard_error + 0.1 * error);
}

TEST(Frame, StoppedBeforeItsFirstLookItDeliversTheNoisyImageOfWhatThereIs) {
  RenderedFrame frame(small_job());
  const std::vector<Work> work = frame.begin();
  frame.fold(rendered(std::get<RenderTask>(work.front()), frame.layout(), 0.6f));
  frame.stop(StopReason::interrupted);
  const FrameImage image = frame.image();
  EXPECT_EQ(image.rounds, 0);
  EXPECT_GT(image.filtered.at(0, 0, 0), 0.0f);
  EXPECT_EQ(image.filtered.at(0, 149, 89), 0.0f);
  EXPECT_TRUE(frame.fold(rendered(std::get<RenderTask>(work.back()), frame.layout(), 0.6f)).empty());
}

TEST(Frame, PreviewsAreNoisyThenTheLastLooksWithTheTilesOfThisRound) {
  const Job job = small_job();
  RenderedFrame frame(job);
  std::vector<Work> work = frame.begin();
  frame.fold(rendered(std::get<RenderTask>(work.front()), frame.layout(), 0.6f));
  EXPECT_GT(frame.preview().at(0, 0, 0), 0.0f);
  EXPECT_EQ(frame.preview().at(0, 149, 89), 0.0f);
  const auto fold = [&](const Work& task) {
    return frame.fold(rendered(std::get<RenderTask>(task), frame.layout(), 0.6f));
  };
  std::vector<Work> tiles;
  for (const Work& task : work)
    for (const Work& ready : fold(task)) tiles.push_back(ready);
  const auto stitch = [&](const FilterTask& task, float value) {
    frame.stitch(task, Filtered(task.tile.inner, filtered_planes(job.filter), value));
  };
  for (const Work& tile : tiles) stitch(std::get<FilterTask>(tile), 0.5f);
  ASSERT_TRUE(frame.round_complete());
  work = frame.look({});
  ASSERT_FALSE(frame.stopped());
  EXPECT_TRUE(same_bits(frame.preview(), frame.image().filtered));
  tiles.clear();
  for (std::size_t i = 0; i < work.size() && tiles.empty(); ++i) tiles = fold(work[i]);
  ASSERT_FALSE(tiles.empty());
  const auto& task = std::get<FilterTask>(tiles.front());
  stitch(task, 0.75f);
  Image expected = frame.image().filtered;
  paste(expected, Image(task.tile.inner, 3, 0.75f));
  EXPECT_TRUE(same_bits(frame.preview(), expected));
}

TEST(Frame, AnAnswerOfAnotherShapeDoesNotFit) {
  RenderedFrame frame(small_job());
  const RenderTask task = std::get<RenderTask>(frame.begin().front());
  Block block = rendered(task, frame.layout(), 0.6f);
  EXPECT_TRUE(frame.fits(task, block));
  block.samples = {64, 128};
  EXPECT_FALSE(frame.fits(task, block));
  EXPECT_FALSE(frame.fits(task, {task.samples, Image(grown(task.region, 1), frame.layout().planes())}));
  EXPECT_FALSE(frame.fits(task, {task.samples, Image(task.region, frame.layout().planes() - 1)}));
}

}  // namespace
}  // namespace tessera
