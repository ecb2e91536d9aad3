// SPDX-License-Identifier: Apache-2.0
#include "coordinator/scheduler.h"

#include <gmock/gmock.h>

#include <random>

namespace tessera {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

Instant at(double s) { return Instant(std::chrono::microseconds(static_cast<std::int64_t>(s * 1e6))); }

Submitted wishes(TaskId first, TaskId last, JobId job = 1) {
  Submitted event;
  for (TaskId id = first; id < last; ++id) event.tasks.push_back({id, job});
  return event;
}

// Commands that are Kind, in order.
template <class Kind>
std::vector<Kind> only(const std::vector<Command>& commands) {
  std::vector<Kind> found;
  for (const Command& c : commands)
    if (const auto* kind = std::get_if<Kind>(&c)) found.push_back(*kind);
  return found;
}

const SchedulerOptions kPlain{
    .silence = Millis{10'000}, .grace = Millis{3'000}, .max_attempts = 3, .ahead = 0};
SchedulerOptions without_endgame() {
  SchedulerOptions options = kPlain;
  options.endgame = false;
  return options;
}

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

TEST(Scheduler, AnyWordRenewsALeaseAndSilenceEndsIt) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  EXPECT_EQ(s.next_deadline(), at(10));
  s.handle(Heard{"a"}, at(9));
  EXPECT_EQ(s.next_deadline(), at(19));
  EXPECT_THAT(s.handle(TimePassed{}, at(18.9)), IsEmpty());
  s.handle(Joined{"b", 1}, at(18.9));
  EXPECT_THAT(s.handle(TimePassed{}, at(19)), ElementsAre(Forget{"a"}, AssignTask{"b", 1, 2}));
  EXPECT_THAT(s.handle(Heard{"a"}, at(20)), ElementsAre(AskHello{"a"}));
}

TEST(Scheduler, AHardTaskMayTakeForEver) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  for (int hour = 1; hour < 100; ++hour)
    for (int beat = 0; beat < 10; ++beat) {
      const Instant now = at(hour * 3600.0 + beat);
      EXPECT_THAT(s.handle(Heard{"a", std::vector<Held>{{1, 1}}}, now), IsEmpty());
    }
}

// The loop was away: mail that waited proves who is alive before time may pass.
TEST(Scheduler, OnlyPassingTimeEndsLeases) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(Joined{"b", 1}, at(0));
  EXPECT_THAT(s.handle(Heard{"a"}, at(100)), IsEmpty());
  EXPECT_THAT(s.handle(Heard{"b"}, at(100)), IsEmpty());
  EXPECT_THAT(s.handle(TimePassed{}, at(100)), IsEmpty());
}

TEST(Scheduler, ATaskAtWhichWorkersDieIsGivenUpThoseInTheirQueuesAreNot) {
  SchedulerOptions options = without_endgame();
  options.ahead = 1;
  Scheduler s(options);
  s.handle(wishes(1, 3), at(0));
  std::vector<GiveUp> given_up;
  for (int i = 0; i < 3; ++i) {
    s.handle(Joined{"worker" + std::to_string(i), 1}, at(i * 100));
    for (GiveUp& g : only<GiveUp>(s.handle(TimePassed{}, at(i * 100 + 50)))) given_up.push_back(g);
  }
  EXPECT_THAT(given_up, ElementsAre(GiveUp{1, "worker worker2 fell silent while at it", false}));
  EXPECT_THAT(s.handle(Joined{"d", 1}, at(1000)), ElementsAre(AssignTask{"d", 2, 4}));
}

TEST(Scheduler, AGoodbyeGivesTasksBackWithoutBlame) {
  Scheduler s(without_endgame());
  s.handle(wishes(1, 2), at(0));
  for (int i = 0; i < 10; ++i) {
    const WorkerId id = "worker" + std::to_string(i);
    EXPECT_THAT(s.handle(Joined{id, 1}, at(i)), ElementsAre(AssignTask{id, 1, Attempt(i + 1)}));
    EXPECT_THAT(s.handle(Left{id}, at(i)), IsEmpty());
  }
}

TEST(Scheduler, ALateHelloDoesNotBringBackWhoSaidGoodbye) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(Left{"a"}, at(1));
  s.handle(Joined{"a", 1}, at(2));
  s.handle(Left{"a"}, at(2));
  EXPECT_THAT(s.handle(wishes(1, 2), at(3)), IsEmpty());
  EXPECT_THAT(s.handle(Heard{"a"}, at(3)), IsEmpty());
  EXPECT_THAT(s.handle(TimePassed{}, at(20)), IsEmpty());  // forgotten in silence
  EXPECT_EQ(s.next_deadline(), std::nullopt);
  EXPECT_THAT(s.handle(Heard{"a"}, at(21)), ElementsAre(AskHello{"a"}));
}

TEST(Scheduler, AWorkerThatSaysHelloAgainKeepsItsTasks) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 4), at(0));
  EXPECT_THAT(s.handle(Joined{"a", 1}, at(1)), IsEmpty());
  EXPECT_THAT(s.handle(Joined{"a", 2}, at(1)), ElementsAre(AssignTask{"a", 2, 1}));
}

TEST(Scheduler, AnIdleWorkerTakesASecondCopyOfTheTaskThatIsAtWorkTheLongest) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 2}, at(0));
  s.handle(wishes(1, 3), at(0));
  EXPECT_THAT(s.handle(Joined{"b", 3}, at(5)), ElementsAre(AssignTask{"b", 1, 2}, AssignTask{"b", 2, 2}));
  EXPECT_THAT(s.handle(Joined{"c", 1}, at(6)), IsEmpty()) << "two copies are enough";
  EXPECT_THAT(s.handle(Done{"b", 1, 2}, at(7)), ElementsAre(Accept{1}, RevokeTask{"a", 1, 1}));
}

TEST(Scheduler, AnIdleWorkerPrefersWhatOnlyLiesInAQueue) {
  SchedulerOptions options = kPlain;
  options.ahead = 1;
  Scheduler s(options);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 3), at(0));
  EXPECT_THAT(s.handle(Joined{"b", 1}, at(5)), ElementsAre(AssignTask{"b", 2, 2}));
}

TEST(Scheduler, ACopyThatFailsLeavesTheOtherAtWork) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  s.handle(Joined{"b", 1}, at(1));
  EXPECT_THAT(s.handle(Failed{"b", 1, 2, "bad day"}, at(2)), IsEmpty());
  EXPECT_THAT(s.handle(Done{"a", 1, 1}, at(3)), ElementsAre(Accept{1}));
}

TEST(Scheduler, AnAssignThatWasLostIsNoticedAndMadeGood) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  const Heard nothing{"a", std::vector<Held>{}};
  EXPECT_THAT(s.handle(nothing, at(3)), IsEmpty()) << "it may still be under way";
  EXPECT_THAT(s.handle(nothing, at(3.1)), ElementsAre(AssignTask{"a", 1, 2}));
}

TEST(Scheduler, AResultThatWasLostIsNoticedAfterTheGraceAndNotBlamed) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  for (int i = 1; i < 20; ++i) s.handle(Heard{"a", std::vector<Held>{{1, 1}}}, at(i));
  EXPECT_THAT(s.handle(Heard{"a", std::vector<Held>{}}, at(20)), IsEmpty());
  EXPECT_THAT(s.handle(Heard{"a", std::vector<Held>{}}, at(22.5)), ElementsAre(AssignTask{"a", 1, 2}));
}

TEST(Scheduler, ARevokeThatWasLostIsRepeated) {
  Scheduler s(kPlain);
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  EXPECT_THAT(s.handle(WithdrawnJob{1}, at(1)), ElementsAre(RevokeTask{"a", 1, 1}));
  EXPECT_THAT(s.handle(Heard{"a", std::vector<Held>{{1, 1}}}, at(2)), ElementsAre(RevokeTask{"a", 1, 1}));
}

TEST(Scheduler, ATaskThoughtLostThatTurnsUpIsLeftToFinish) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  s.handle(TimePassed{}, at(10));
  s.handle(Joined{"a", 1}, at(11));  // it gets the task anew, under attempt 2, but holds it still
  EXPECT_THAT(s.handle(Heard{"a", std::vector<Held>{{1, 1}}}, at(12)), IsEmpty());
  s.handle(TimePassed{}, at(22));
  s.handle(Joined{"b", 1}, at(22));
  s.handle(Joined{"c", 1}, at(23));
  EXPECT_THAT(s.handle(Heard{"c", std::vector<Held>{{1, 3}}}, at(24)), IsEmpty());
  s.handle(Joined{"d", 1}, at(24));
  EXPECT_THAT(s.handle(Heard{"d", std::vector<Held>{{1, 3}}}, at(24)), ElementsAre(RevokeTask{"d", 1, 3}));
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
