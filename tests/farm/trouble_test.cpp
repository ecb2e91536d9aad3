// SPDX-License-Identifier: Apache-2.0
// What a coordinator does when tasks fail, answers are wrong, people interrupt and time runs out.
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/plan.h"
#include "tests/farm/small_scene.h"
#include "tests/farm/test_farm.h"

namespace tessera::farm {
namespace {

// Answers at once, with grey pixels; a test may meddle with what it does.
class QuickRunner : public TaskRunner {
 public:
  std::function<void(const Task&)> before = [](const Task&) {};
  std::function<void(TaskResult&)> after = [](TaskResult&) {};

  TaskResult run(const Job& job, const Task& task, const FilterInput&, const std::atomic<bool>&) override {
    before(task);
    TaskResult result = answer(job, task);
    after(result);
    return result;
  }

 private:
  static TaskResult answer(const Job& job, const Task& task) {
    if (const auto* filter = std::get_if<FilterTask>(&task.work))
      return FilterDone{.filtered = Image(filter->tile.inner, kFilteredPlanes, 0.5f)};
    const auto& work = std::get<RenderTask>(task.work);
    const FilmLayout layout(film_aovs(job));
    Block block{work.samples,
                Image(work.region, layout.planes(), 0.25f * static_cast<float>(work.samples.count()))};
    for (const Half half : {Half::a, Half::b})
      for (float& n : block.sums.plane(FilmLayout::count(half)))
        n = 0.5f * static_cast<float>(work.samples.count());
    return RenderDone{.block = std::move(block)};
  }
};

Job quick_job() {
  Job job;
  job.scene.hash = "0";
  job.render.size = {200, 100};
  job.acceptance.max_samples = 64;
  return job;
}

// One worker with one slot, one coordinator.
struct SmallFarm {
  explicit SmallFarm(TaskRunner& runner, const CoordinatorOptions& options = {})
      : router(context, {"inproc://farm"}),
        coordinator(router, options),
        hand(std::make_unique<ZmqDealer>(context, "inproc://farm", "worker"), runner) {}
  ZmqContext context;
  ZmqRouter router;
  Coordinator coordinator;
  Hand hand;
};

TEST(Trouble, ATaskThatFailsOnceIsTriedAgain) {
  QuickRunner runner;
  std::atomic<int> calls = 0;
  runner.before = [&](const Task&) {
    if (++calls == 2) throw std::runtime_error("a cosmic ray");
  };
  SmallFarm farm(runner);
  const JobReport report = farm.coordinator.run(quick_job());
  EXPECT_FALSE(report.failure);
  EXPECT_EQ(report.image.pixel_samples, 200 * 100 * 64);
}

TEST(Trouble, ATaskThatAlwaysFailsFailsTheJobWithItsReason) {
  QuickRunner runner;
  runner.before = [](const Task&) { throw std::runtime_error("no more toner"); };
  SmallFarm farm(runner);
  const JobReport report = farm.coordinator.run(quick_job());
  ASSERT_TRUE(report.failure);
  EXPECT_NE(report.failure->find("no more toner"), std::string::npos) << *report.failure;
  EXPECT_FALSE(report.bad_input);
}

TEST(Trouble, BadInputIsNotTriedAgain) {
  QuickRunner runner;
  std::atomic<int> calls = 0;
  runner.before = [&](const Task&) {
    ++calls;
    throw InputError("scene.json:/meshes/0", "is empty", "at least one triangle");
  };
  SmallFarm farm(runner);
  const JobReport report = farm.coordinator.run(quick_job());
  ASSERT_TRUE(report.failure);
  EXPECT_TRUE(report.bad_input);
  EXPECT_NE(report.failure->find("scene.json:/meshes/0"), std::string::npos);
}

TEST(Trouble, AnAnswerThatDoesNotFitItsTaskIsAFailureOfThatAttempt) {
  QuickRunner runner;
  std::atomic<int> calls = 0;
  runner.after = [&](TaskResult& result) {
    auto* render = std::get_if<RenderDone>(&result);
    if (render != nullptr && ++calls == 1) render->block.samples = {64, 128};
  };
  SmallFarm farm(runner);
  const JobReport report = farm.coordinator.run(quick_job());
  EXPECT_FALSE(report.failure);
  EXPECT_EQ(report.image.pixel_samples, 200 * 100 * 64);
}

TEST(Trouble, AnInterruptEndsTheJobWithTheImageOfTheLastLook) {
  QuickRunner runner;
  SmallFarm farm(runner);
  Job job = quick_job();
  job.acceptance.relmse = 1e-9;
  job.acceptance.max_samples = 1 << 20;
  const auto interrupt = [&](const Progress& p) {
    if (p.round == 3) farm.coordinator.interrupt();
  };
  // The halves differ, so that the target is never met.
  runner.after = [](TaskResult& result) {
    if (auto* filter = std::get_if<FilterDone>(&result))
      for (int c = 3; c < 6; ++c)
        for (float& v : filter->filtered.plane(c)) v = 1.0f;
  };
  const JobReport report = farm.coordinator.run(job, {.progress = interrupt});
  EXPECT_EQ(report.image.stop, StopReason::interrupted);
  EXPECT_EQ(report.image.rounds, 2);
  EXPECT_EQ(report.image.filtered.at(0, 0, 0), 0.5f);
}

TEST(Trouble, ASnapshotShowsTheFrameAndTheJobGoesOn) {
  QuickRunner runner;
  SmallFarm farm(runner);
  int snapshots = 0;
  JobWatcher watcher;
  watcher.progress = [&, asked = false](const Progress& p) mutable {
    if (p.samples_done > 0 && !std::exchange(asked, true)) farm.coordinator.request_snapshot();
  };
  watcher.snapshot = [&](std::size_t, const JobReport& report) {
    ++snapshots;
    EXPECT_GT(report.image.pixel_samples, 0);
  };
  const JobReport report = farm.coordinator.run(quick_job(), watcher);
  EXPECT_EQ(snapshots, 1);
  EXPECT_EQ(report.image.pixel_samples, 200 * 100 * 64);
}

TEST(Trouble, AnAbsurdJobIsRefusedBeforeAnythingRuns) {
  QuickRunner runner;
  SmallFarm farm(runner);
  Job job = quick_job();
  job.render.size = {0, 100};
  EXPECT_THROW(farm.coordinator.run(job), InputError);
  job = quick_job();
  job.acceptance.max_samples = 1 << 30;
  EXPECT_THROW(farm.coordinator.run(job), InputError);
}

}  // namespace
}  // namespace tessera::farm
