// SPDX-License-Identifier: Apache-2.0
// How long a job takes on workers of unlike speeds, in virtual time, against the sum of their speeds.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/storm.h"

namespace tessera::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;

// Tasks take 50 to 100 ms at speed 1.
double seconds_of(TaskId id) { return 0.05 + 0.05 * static_cast<double>(id * 2654435761u % 1000) / 1000; }

// Seconds that the job took, over the ideal: all its work, over the sum of speeds. One slot a worker.
double ratio(const std::vector<double>& speeds, int tasks) {
  Storm storm(1, {.seed = 1, .delay_min = milliseconds(1), .delay_max = milliseconds(1)}, SchedulerOptions{});
  double speed = 0, work = 0;
  for (const double s : speeds) {
    speed += s;
    storm.hire({.work = [s](TaskId id) {
      return Instant::duration(static_cast<std::int64_t>(1e6 * seconds_of(id) / s));
    }});
  }
  Submitted job;
  for (TaskId id = 1; id <= static_cast<TaskId>(tasks); ++id) {
    job.tasks.push_back({id, 1});
    work += seconds_of(id);
  }
  storm.office().submit(job, storm.now());
  EXPECT_TRUE(storm.run([&] { return storm.office().open() == 0; }, Instant(minutes(10))));
  return std::chrono::duration<double>(storm.now().time_since_epoch()).count() / (work / speed);
}

TEST(Straggler, AWorkerTenTimesSlowerDoesNotHoldUpTheJob) {
  for (const int tasks : {60, 240, 1000})
    for (const std::vector<double>& speeds :
         {std::vector<double>{1, 0.1}, {1, 1, 0.1}, {1, 1, 1, 0.1}, {2, 1, 0.5, 0.1}}) {
      const double measured = ratio(speeds, tasks);
      RecordProperty("tasks_" + std::to_string(tasks) + "_workers_" + std::to_string(speeds.size()) + "_" +
                         std::to_string(static_cast<int>(speeds.front())),
                     std::to_string(measured));
      EXPECT_LE(measured, 1.15) << tasks << " tasks, " << speeds.size() << " workers";
    }
}

}  // namespace
}  // namespace tessera::sim
