// SPDX-License-Identifier: Apache-2.0
// Many jobs: bands, flows, warm scenes, pauses, device classes, leases by time, workers set aside.
#include <map>
#include <utility>

#include "tests/coordinator/scheduler_words.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Submitted job(JobId id, TaskId first, int tasks, const Standing& standing, const Wish& like = {}) {
  Submitted event{{}, standing};
  for (int i = 0; i < tasks; ++i) {
    event.tasks.push_back(like);
    event.tasks.back().task = first + i;
    event.tasks.back().job = id;
  }
  return event;
}

// Answers for a worker that does one task after the other: the tasks in the order in which it got them.
std::vector<TaskId> work_through(Scheduler& s, const WorkerId& worker, std::vector<Command> commands,
                                 int tasks) {
  std::vector<TaskId> done;
  while (static_cast<int>(done.size()) < tasks) {
    const auto given = only<AssignTask>(commands);
    if (given.empty()) break;
    done.push_back(given.front().task);
    commands = s.handle(Done{worker, given.front().task, given.front().attempt}, at(1));
  }
  return done;
}

TEST(FarmScheduler, AHigherBandComesFirstThenALowerRank) {
  Scheduler s(kPlain);
  s.handle(job(1, 10, 1, {.rank = 0, .band = 1}), at(0));
  s.handle(job(2, 20, 1, {.rank = 7, .band = 5}), at(0));
  s.handle(job(3, 30, 1, {.rank = 3, .band = 5}), at(0));
  EXPECT_THAT(work_through(s, "a", s.handle(Joined{"a", 1}, at(0)), 9), ElementsAre(30, 20, 10));
}

TEST(FarmScheduler, FlowsOfABandShareByCost) {
  Scheduler s(kPlain);
  s.handle(job(1, 100, 90, {.flow = "dear"}, {.cost = 3}), at(0));
  s.handle(job(2, 200, 90, {.flow = "cheap"}, {.cost = 1}), at(0));
  double dear = 0, cheap = 0;
  for (const TaskId id : work_through(s, "a", s.handle(Joined{"a", 1}, at(0)), 80)) {
    (id < 200 ? dear : cheap) += id < 200 ? 3 : 1;
    EXPECT_LE(std::abs(dear - cheap), 3) << "the cost of one task";
  }
}

TEST(FarmScheduler, AFlowThatWasAwayHasSavedNothingUp) {
  Scheduler s(kPlain);
  s.handle(job(1, 100, 60, {.flow = "busy"}), at(0));
  s.handle(Joined{"a", 1}, at(0));
  std::vector<Command> last;
  for (TaskId id = 100; id < 140; ++id) last = s.handle(Done{"a", id, 1}, at(1));  // 140 is at work
  s.handle(job(2, 200, 20, {.flow = "late"}), at(1));
  int late = 0;
  for (const TaskId id : work_through(s, "a", last, 11)) late += id >= 200;
  EXPECT_THAT(late, testing::AllOf(testing::Ge(4), testing::Le(6))) << "of 11";
}

// The bound that waiting.h states, with workers that have other scenes loaded.
TEST(FarmScheduler, WarmScenesArePreferredWithinTheSlackAndNobodyStarves) {
  SchedulerOptions options = kPlain;
  options.affinity_slack = 10;
  Scheduler s(options);
  for (const JobId id : {1, 2, 3, 4})
    s.handle(job(id, 1000 * id, 400, {.flow = std::to_string(id)}, {.cost = 2, .scene = std::to_string(id)}),
             at(0));
  int loads = 0;
  TaskId last = 0, before = 0;  // its last two scenes
  std::map<TaskId, double> had;
  for (const TaskId id : work_through(s, "a", s.handle(Joined{"a", 1}, at(0)), 400)) {
    const TaskId scene = id / 1000;
    loads += scene != last && scene != before;
    if (scene != last) before = std::exchange(last, scene);
    had[scene] += 2;
    for (const TaskId flow : {1, 2, 3, 4}) EXPECT_LE(std::abs(had[flow] - had[scene]), 10 + 2);
  }
  EXPECT_LT(loads, 400 / 3) << "without a slack each task is of a scene that is not loaded";
}

TEST(FarmScheduler, APausedJobWaitsWhileWhatWasGivenOutGoesOn) {
  Scheduler s(without_endgame());
  s.handle(job(1, 10, 3, {}), at(0));
  s.handle(Joined{"a", 1}, at(0));
  EXPECT_THAT(s.handle(PausedJob{1}, at(1)), IsEmpty());
  s.handle(job(1, 13, 1, {}), at(1));
  EXPECT_THAT(s.handle(Done{"a", 10, 1}, at(2)), ElementsAre(Accept{10}));
  EXPECT_THAT(s.handle(ResumedJob{1}, at(3)), ElementsAre(AssignTask{"a", 11, 1}));
}

TEST(FarmScheduler, AJobIsGivenAnotherStanding) {
  Scheduler s(without_endgame());
  s.handle(job(1, 10, 2, {.band = 2}), at(0));
  s.handle(job(2, 20, 2, {.band = 1}), at(0));
  s.handle(Joined{"a", 1}, at(0));
  EXPECT_THAT(s.handle(Reranked{2, {.band = 3}}, at(1)), IsEmpty());
  EXPECT_THAT(s.handle(Done{"a", 10, 1}, at(2)), ElementsAre(Accept{10}, AssignTask{"a", 20, 1}));
}

TEST(FarmScheduler, OneDeviceClassFiltersAFrameUntilItsLastWorkerLeaves) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1, "cpu"}, at(0));
  EXPECT_THAT(s.handle(job(1, 10, 3, {}, {.filter = true}), at(0)),
              ElementsAre(ClassChanged{1, "", "cpu"}, AssignTask{"a", 10, 1}));
  EXPECT_THAT(s.handle(Joined{"b", 2, "gpu"}, at(0)), IsEmpty()) << "not even a second copy";
  EXPECT_THAT(s.handle(Done{"b", 10, 1}, at(1)), IsEmpty()) << "those are other bits";
  EXPECT_THAT(s.handle(Left{"a"}, at(2)),
              ElementsAre(ClassChanged{1, "cpu", "gpu"}, AssignTask{"b", 10, 2}, AssignTask{"b", 11, 1}));
}

TEST(FarmScheduler, AClassWithoutANameIsAClass) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1, ""}, at(0));
  Wish filter;
  filter.filter = true;
  s.handle(job(1, 10, 1, {}, filter), at(0));
  s.handle(Done{"a", 10, 1}, at(1));  // nothing is left of the job, but its class
  s.handle(Joined{"b", 1, ""}, at(1));
  s.handle(Left{"a"}, at(2));
  s.handle(job(1, 11, 1, {}, filter), at(2));
  s.handle(Left{"b"}, at(3));
  EXPECT_EQ(only<AssignTask>(s.handle(Joined{"c", 1, ""}, at(4))).front().task, 11u);
}

TEST(FarmScheduler, ATaskWaitsRatherThanGoToWhomItAvoids) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  EXPECT_THAT(s.handle(job(1, 10, 1, {}, {.avoid = "a"}), at(0)), IsEmpty());
  EXPECT_THAT(s.handle(Done{"a", 10, 1}, at(0)), IsEmpty()) << "nor is its answer taken";
  EXPECT_THAT(s.handle(Joined{"b", 1}, at(1)), ElementsAre(AssignTask{"b", 10, 1}));
}

TEST(FarmScheduler, AWorkerHoldsWhatLastsAboutASecondOnIt) {
  Scheduler s(kPlain);
  s.handle(job(1, 1, 1000, {}), at(0));
  s.handle(Joined{"a", 1}, at(0));
  EXPECT_EQ(only<AssignTask>(s.handle(Done{"a", 1, 1, 0.05}, at(0.06))).size(), 20u);
  EXPECT_EQ(s.workers().front().held, 20);
}

TEST(FarmScheduler, NotMoreBytesTravelAheadThanAllowed) {
  SchedulerOptions options = kPlain;
  options.ahead = 10;
  options.bytes_ahead = 250;
  Scheduler s(options);
  s.handle(Joined{"a", 2}, at(0));
  EXPECT_EQ(s.handle(job(1, 1, 20, {}, {.bytes = 100}), at(0)).size(), 4u) << "two at work, two ahead";
}

TEST(FarmScheduler, AWorkerIsSetAsideByNameAndReleased) {
  SchedulerOptions options = without_endgame();
  options.set_aside_after = 2;
  Scheduler s(options);
  s.handle(Joined{"a", 1, "", "bad"}, at(0));
  s.handle(job(1, 1, 2, {}), at(0));
  s.handle(Joined{"b", 1, "", "good"}, at(0));
  s.handle(Failed{"a", 1, 1, "disk full"}, at(1));
  s.handle(Done{"b", 2, 1}, at(2));
  EXPECT_THAT(only<SetAside>(s.handle(Done{"b", 1, 2}, at(3))), IsEmpty());
  s.handle(job(1, 3, 1, {}), at(6));
  s.handle(Failed{"a", 3, 1, "disk full"}, at(7));
  const auto said = only<SetAside>(s.handle(Done{"b", 3, 2}, at(8)));
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said.front().name, "bad");
  EXPECT_THAT(said.front().reason, testing::HasSubstr("disk full"));
  EXPECT_EQ(only<SetAside>(s.handle(Joined{"a2", 1, "", "bad"}, at(9))).size(), 1u)
      << "a new id is no way out";
  s.handle(Left{"b"}, at(10));
  EXPECT_THAT(s.handle(job(1, 4, 1, {}), at(10)), IsEmpty());
  EXPECT_THAT(s.handle(Released{"bad"}, at(11)), ElementsAre(AssignTask{"a", 4, 1}));
}

}  // namespace
}  // namespace tessera
