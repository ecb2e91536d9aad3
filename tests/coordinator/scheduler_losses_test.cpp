// SPDX-License-Identifier: Apache-2.0
// Silence, goodbyes, and messages that were lost on the way.
#include "tests/coordinator/scheduler_words.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Scheduler, AnyWordRenewsALeaseAndSilenceEndsIt) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 2), at(0));
  s.handle(Heard{"a"}, at(0));
  EXPECT_EQ(s.next_deadline(), at(10));
  s.handle(Heard{"a"}, at(9));
  EXPECT_EQ(s.next_deadline(), at(19));
  EXPECT_THAT(s.handle(TimePassed{}, at(18.9)), IsEmpty());
  s.handle(Joined{"b", 1}, at(18.9));
  EXPECT_THAT(s.handle(TimePassed{}, at(19)), ElementsAre(Forget{"a"}, AssignTask{"b", 1, 2}));
  EXPECT_THAT(s.handle(Heard{"a"}, at(20)), ElementsAre(AskHello{"a"}));
}

// Idle workers speak seldom. One that is dead does not live on by what it is given again and again.
TEST(Scheduler, SilenceCountsFromTheFirstTaskThatAnIdleWorkerGets) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  EXPECT_EQ(s.next_deadline(), at(30));
  s.handle(wishes(1, 2), at(28));
  EXPECT_EQ(s.next_deadline(), at(58));
  s.handle(WithdrawnJob{1}, at(35));
  s.handle(wishes(1, 2, 2), at(36));
  EXPECT_EQ(s.next_deadline(), at(58));
  s.handle(Heard{"a"}, at(37));
  EXPECT_EQ(s.next_deadline(), at(47)) << "it is at work";
  s.handle(WithdrawnJob{2}, at(37));
  s.handle(Heard{"a"}, at(38));
  EXPECT_EQ(s.next_deadline(), at(68));
  s.handle(wishes(1, 2, 3), at(60));
  EXPECT_THAT(s.handle(TimePassed{}, at(89)), IsEmpty());
  EXPECT_THAT(s.handle(TimePassed{}, at(90)), ElementsAre(Forget{"a"}));
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
  EXPECT_THAT(s.handle(TimePassed{}, at(40)), IsEmpty());  // forgotten in silence
  EXPECT_EQ(s.next_deadline(), std::nullopt);
  EXPECT_THAT(s.handle(Heard{"a"}, at(41)), ElementsAre(AskHello{"a"}));
}

TEST(Scheduler, AWorkerThatSaysHelloAgainKeepsItsTasks) {
  Scheduler s(without_endgame());
  s.handle(Joined{"a", 1}, at(0));
  s.handle(wishes(1, 4), at(0));
  EXPECT_THAT(s.handle(Joined{"a", 1}, at(1)), IsEmpty());
  EXPECT_THAT(s.handle(Joined{"a", 2}, at(1)), ElementsAre(AssignTask{"a", 2, 1}));
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

}  // namespace
}  // namespace tessera
