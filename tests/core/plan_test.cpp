// SPDX-License-Identifier: Apache-2.0
#include "core/plan.h"

#include <gtest/gtest.h>

#include <numeric>

namespace tessera {
namespace {

Job job_of(Size size, Size tile, int task_samples) {
  Job job;
  job.render.size = size;
  job.tile = tile;
  job.task_samples = task_samples;
  return job;
}

// How often each (pixel, sample) is asked for.
TEST(Plan, EveryMissingSampleOfEveryPixelIsPlannedExactlyOnce) {
  for (const Size tile : {Size{1, 1}, Size{37, 53}, Size{64, 64}, Size{500, 500}})
    for (const int task_samples : {1, 1000, 1 << 20}) {
      const Job job = job_of({97, 75}, tile, task_samples);
      const std::vector<int> have{0, 16, 32, 16}, want{64, 16, 128, 32};
      const std::vector<Region> cells = plan_cells(job);
      ASSERT_EQ(cells.size(), have.size());
      std::vector<std::int64_t> sum(97 * 75), squares(97 * 75);
      for (const RenderTask& task : plan_render(job, have, want)) {
        EXPECT_TRUE(is_dyadic(task.samples));
        for (int y = task.region.y0; y < task.region.y1; ++y)
          for (int x = task.region.x0; x < task.region.x1; ++x)
            for (int s = task.samples.begin; s < task.samples.end; ++s) {
              sum[y * 97 + x] += s;
              squares[y * 97 + x] += std::int64_t(s) * s;
            }
      }
      for (std::size_t i = 0; i < cells.size(); ++i) {
        std::int64_t s1 = 0, s2 = 0;
        for (int s = have[i]; s < want[i]; ++s) s1 += s, s2 += std::int64_t(s) * s;
        const Region& c = cells[i];
        for (int y = c.y0; y < c.y1; ++y)
          for (int x = c.x0; x < c.x1; ++x) {
            ASSERT_EQ(sum[y * 97 + x], s1);
            ASSERT_EQ(squares[y * 97 + x], s2);
          }
      }
    }
}

TEST(Plan, TasksOfARoundOfManySamplesAreLarger) {
  const auto tasks = [](int samples) {
    const Job job = job_of({640, 640}, {64, 64}, 1 << 18);
    return plan_render(job, std::vector<int>(100, 0), std::vector<int>(100, samples));
  };
  for (const auto& [samples, of_each] :
       {std::pair{64, 64}, {128, 64}, {256, 64}, {512, 128}, {1024, 256}, {8192, 256}}) {
    const auto planned = tasks(samples);
    EXPECT_EQ(planned.size(), 100u * samples / of_each) << samples;
    for (const RenderTask& task : planned) EXPECT_EQ(task.samples.count(), of_each) << samples;
  }
}

TEST(Plan, ACropIsPlannedOnTheFramesOwnGrid) {
  Job job = job_of({200, 200}, {64, 64}, 1 << 20);
  job.crop = Region{50, 60, 70, 70};
  EXPECT_EQ(plan_cells(job),
            (std::vector<Region>{{50, 60, 64, 64}, {64, 60, 70, 64}, {50, 64, 64, 70}, {64, 64, 70, 70}}));
}

}  // namespace
}  // namespace tessera
