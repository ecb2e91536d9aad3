// SPDX-License-Identifier: Apache-2.0
#include "tests/coordinator/scheduler_words.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

TEST(Scheduler, TasksAreGivenInTheOrderInWhichTheyAreWanted) {
  Scheduler s(kPlain);
  s.handle(wishes(5, 7), at(0));
  s.handle(wishes(1, 3), at(0));
  EXPECT_THAT(s.handle(Joined{"a", 3}, at(0)),
              ElementsAre(AssignTask{"a", 5, 1}, AssignTask{"a", 6, 1}, AssignTask{"a", 1, 1}));
  EXPECT_THAT(s.handle(Done{"a", 6, 1}, at(1)), ElementsAre(Accept{6}, AssignTask{"a", 2, 1}));
}

TEST(Scheduler, FreeSlotsOfAllWorkersComeBeforeTasksAhead) {
  SchedulerOptions options = kPlain;
  options.ahead = 1;
  Scheduler s(options);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(Joined{"b", 2}, at(0));
  EXPECT_THAT(s.handle(wishes(1, 5), at(0)), ElementsAre(AssignTask{"a", 1, 1}, AssignTask{"b", 2, 1},
                                                         AssignTask{"b", 3, 1}, AssignTask{"a", 4, 1}));
}

TEST(Scheduler, AWorkerHoldsNoMoreThanItsSlotsAndThoseAhead) {
  SchedulerOptions options = kPlain;
  options.ahead = 2;
  Scheduler s(options);
  s.handle(Joined{"a", 3}, at(0));
  EXPECT_EQ(s.handle(wishes(1, 100), at(0)).size(), 9u);
}

TEST(Scheduler, AResultIsAcceptedOnceWhoeverSendsIt) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  EXPECT_THAT(s.handle(Done{"stranger", 1, 9}, at(1)),
              ElementsAre(AskHello{"stranger"}, Accept{1}, RevokeTask{"a", 1, 1}));
  EXPECT_THAT(s.handle(Done{"a", 1, 1}, at(2)), IsEmpty());
  EXPECT_THAT(s.handle(Done{"a", 77, 1}, at(2)), IsEmpty());
}

TEST(Scheduler, AFailedTaskIsTriedByAnotherWorkerEvenIfItMustWaitForOne) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 3), at(0));
  s.handle(Joined{"b", 1}, at(0));
  EXPECT_THAT(s.handle(Failed{"a", 1, 1, "bad day"}, at(1)), IsEmpty());
  EXPECT_THAT(s.handle(Done{"b", 2, 1}, at(2)), ElementsAre(Accept{2}, AssignTask{"b", 1, 2}));
}

TEST(Scheduler, AFailedTaskIsTriedAgainByTheOnlyWorker) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  EXPECT_THAT(s.handle(Failed{"a", 1, 1, "bad day"}, at(1)), ElementsAre(AssignTask{"a", 1, 2}));
}

TEST(Scheduler, ATaskThatWaitedForAnotherWorkerGoesToTheLastOneLeft) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(Joined{"b", 1}, at(0));
  s.handle(wishes(1, 3), at(0));
  EXPECT_THAT(s.handle(Failed{"a", 1, 1, "bad day"}, at(1)), IsEmpty());
  EXPECT_THAT(s.handle(Left{"b"}, at(2)), ElementsAre(AssignTask{"a", 1, 2}));
  EXPECT_THAT(s.handle(Done{"a", 1, 2}, at(3)), ElementsAre(Accept{1}, AssignTask{"a", 2, 2}));
}

TEST(Scheduler, ARetryKeepsItsPlaceInTheOrder) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(Joined{"b", 1}, at(0));
  s.handle(wishes(1, 9), at(0));
  s.handle(Failed{"a", 1, 1, "bad day"}, at(1));
  EXPECT_THAT(s.handle(Done{"b", 2, 1}, at(2)), ElementsAre(Accept{2}, AssignTask{"b", 1, 2}));
}

TEST(Scheduler, ATaskThatFailsTooOftenIsGivenUpWithItsLastReason) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  s.handle(Failed{"a", 1, 1, "first"}, at(1));
  s.handle(Failed{"a", 1, 2, "second"}, at(2));
  EXPECT_THAT(s.handle(Failed{"a", 1, 3, "third"}, at(3)), ElementsAre(GiveUp{1, "third", false}));
  EXPECT_THAT(s.handle(Done{"a", 1, 3}, at(4)), IsEmpty());
}

TEST(Scheduler, AFailureThatIsToldTwiceCountsOnce) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  for (int i = 0; i < 5; ++i) s.handle(Failed{"a", 1, 1, "again"}, at(1));
  EXPECT_THAT(s.handle(Done{"a", 1, 2}, at(2)), ElementsAre(Accept{1}));
}

// Else an idle worker would take a second copy each time one fails, and it would never be without.
TEST(Scheduler, ATaskThatFailsOnTwoIdleWorkersIsGivenUpToo) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(Joined{"b", 1}, at(0));
  std::vector<AssignTask> todo = only<AssignTask>(s.handle(wishes(1, 2), at(0)));
  std::size_t given_up = 0;
  for (std::size_t i = 0; i < todo.size() && i < 100; ++i) {
    const auto commands = s.handle(Failed{todo[i].worker, 1, todo[i].attempt, "poison"}, at(1));
    given_up += only<GiveUp>(commands).size();
    for (const AssignTask& next : only<AssignTask>(commands)) todo.push_back(next);
  }
  EXPECT_EQ(given_up, 1u);
  EXPECT_LE(todo.size(), 4u);
}

TEST(Scheduler, BadInputIsGivenUpAtOnce) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(Joined{"b", 1}, at(0));
  s.handle(wishes(1, 2), at(0));  // b has a second copy
  EXPECT_THAT(s.handle(Failed{"a", 1, 1, "no such camera", true}, at(1)),
              ElementsAre(GiveUp{1, "no such camera", true}, RevokeTask{"b", 1, 2}, RevokeTask{"a", 1, 1}));
}

// The loop was away: mail that waited proves who is alive before time may pass.
TEST(Scheduler, AnIdleWorkerTakesASecondCopyOfTheTaskThatIsAtWorkTheLongest) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 2}, at(0));
  s.handle(wishes(1, 3), at(0));
  EXPECT_THAT(s.handle(Joined{"b", 3}, at(5)), ElementsAre(AssignTask{"b", 1, 2}, AssignTask{"b", 2, 2}));
  EXPECT_THAT(s.handle(Joined{"c", 1}, at(6)), IsEmpty()) << "two copies are enough";
  EXPECT_THAT(s.handle(Done{"b", 1, 2}, at(7)), ElementsAre(Accept{1}, RevokeTask{"a", 1, 1}));
}

TEST(Scheduler, AnIdleWorkerTakesOverWhatOnlyLiesInAQueue) {
  SchedulerOptions options = kPlain;
  options.ahead = 1;
  Scheduler s(options);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 3), at(0));
  EXPECT_THAT(s.handle(Joined{"b", 1}, at(5)), ElementsAre(RevokeTask{"a", 2, 1}, AssignTask{"b", 2, 2}));
  EXPECT_EQ(s.counts().moved, 1u);
}

TEST(Scheduler, ACopyThatFailsLeavesTheOtherAtWork) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  s.handle(Joined{"b", 1}, at(1));
  EXPECT_THAT(s.handle(Failed{"b", 1, 2, "bad day"}, at(2)), IsEmpty());
  EXPECT_THAT(s.handle(Done{"a", 1, 1}, at(3)), ElementsAre(Accept{1}));
}

TEST(Scheduler, WithdrawnTasksAreNeitherGivenNorAccepted) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 4), at(0));
  EXPECT_THAT(s.handle(WithdrawnTasks{{1, 2, 99}}, at(1)),
              ElementsAre(RevokeTask{"a", 1, 1}, AssignTask{"a", 3, 1}));
  EXPECT_THAT(s.handle(Done{"a", 1, 1}, at(2)), IsEmpty());
}

TEST(Scheduler, AJobIsWithdrawnWithoutTheOthers) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 2}, at(0));
  s.handle(wishes(1, 3, 1), at(0));
  s.handle(wishes(3, 5, 2), at(0));
  EXPECT_THAT(s.handle(WithdrawnJob{1}, at(1)),
              UnorderedElementsAre(RevokeTask{"a", 1, 1}, RevokeTask{"a", 2, 1}, AssignTask{"a", 3, 1},
                                   AssignTask{"a", 4, 1}));
}

TEST(Scheduler, ABrokenWorkerDoesNotStopTheOthers) {
  Scheduler s(kPlain);
  s.handle(Joined{"broken", 4}, at(0));
  s.handle(Joined{"good", 1}, at(0));
  std::vector<AssignTask> todo = only<AssignTask>(s.handle(wishes(1, 500), at(0)));
  std::size_t accepted = 0;
  for (std::size_t i = 0; i < todo.size(); ++i) {
    const AssignTask t = todo[i];
    const Event event = t.worker == "good" ? Event(Done{t.worker, t.task, t.attempt})
                                           : Event(Failed{t.worker, t.task, t.attempt, "broken"});
    const auto commands = s.handle(event, at(1));
    EXPECT_THAT(only<GiveUp>(commands), IsEmpty());
    accepted += only<Accept>(commands).size();
    for (const AssignTask& next : only<AssignTask>(commands)) todo.push_back(next);
  }
  EXPECT_EQ(accepted, 499u);
}

}  // namespace
}  // namespace tessera
