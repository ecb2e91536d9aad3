// SPDX-License-Identifier: Apache-2.0
#include "coordinator/queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Optional;
using testing::Pair;

constexpr FarmRoom kHungry{.bytes = 100, .hungry = true};
constexpr FarmRoom kBusy{.bytes = 100, .hungry = false};

QueuedJob job(std::uint64_t number, const JobName& name, const std::string& owner = "ann",
              int priority = 50) {
  return {.number = number, .job = name, .owner = owner, .priority = priority, .bytes = 10};
}

TEST(Queue, BeginsTheFirstWhenWorkersRunDry) {
  Queue queue;
  queue.add(job(1, "one"));
  queue.add(job(2, "two"));
  EXPECT_THAT(queue.next(kHungry), Optional(JobName("one")));
  queue.begin("one");
  EXPECT_EQ(queue.next(kBusy), std::nullopt);
  EXPECT_THAT(queue.next(kHungry), Optional(JobName("two")));
}

TEST(Queue, BeginsAnUrgentJobThoughWorkersAreBusy) {
  Queue queue;
  queue.add(job(1, "one"));
  queue.begin("one");
  queue.add(job(2, "urgent", "bob", 51));
  EXPECT_THAT(queue.next(kBusy), Optional(JobName("urgent")));
}

TEST(Queue, OfEqualPrioritiesTakesTheOwnerWhoHasLessUnderWay) {
  Queue queue;
  queue.add(job(1, "a1", "ann"));
  queue.add(job(2, "a2", "ann"));
  queue.add(job(3, "b1", "bob"));
  queue.begin("a1");
  EXPECT_THAT(queue.next(kHungry), Optional(JobName("b1")));
  queue.begin("b1");
  EXPECT_THAT(queue.next(kHungry), Optional(JobName("a2")));
}

TEST(Queue, KeepsToTheMemoryThereIsAndLetsNoSmallJobSlipPastABigOne) {
  Queue queue;
  QueuedJob big = job(1, "big");
  big.bytes = 101;
  queue.add(big);
  queue.add(job(2, "small"));
  EXPECT_EQ(queue.next(kHungry), std::nullopt);
  EXPECT_THAT(queue.next({.bytes = 101, .hungry = true}), Optional(JobName("big")));
}

TEST(Queue, WaitsForWhatAJobComesAfter) {
  Queue queue;
  queue.add(job(1, "light"));
  QueuedJob second = job(2, "render", "ann", 90);
  second.after = {"light"};
  queue.add(second);
  EXPECT_THAT(queue.next(kHungry), Optional(JobName("light")));
  EXPECT_EQ(queue.waits_for("render"), "waits for light");
  queue.begin("light");
  EXPECT_EQ(queue.next(kHungry), std::nullopt);
  queue.end("light", JobState::completed);
  EXPECT_THAT(queue.next(kHungry), Optional(JobName("render")));
}

TEST(Queue, SaysWhichJobsCanNeverBegin) {
  Queue queue;
  queue.add(job(1, "light"));
  QueuedJob second = job(2, "render"), third = job(3, "lost");
  second.after = {"light"};
  third.after = {"nobody"};
  queue.add(second);
  queue.add(third);
  EXPECT_THAT(queue.hopeless(), ElementsAre(Pair("lost", "comes after nobody, which is not known")));
  queue.end("light", JobState::cancelled);
  EXPECT_EQ(queue.hopeless().at("render"), "comes after light, which was cancelled");
  queue.end("render", JobState::failed);
  queue.end("lost", JobState::failed);
  EXPECT_THAT(queue.hopeless(), IsEmpty());
}

TEST(Queue, PausesAndGoesOnWhereItWas) {
  Queue queue;
  queue.add(job(1, "one"));
  queue.pause("one");
  EXPECT_EQ(queue.next(kHungry), std::nullopt);
  queue.resume("one");
  EXPECT_EQ(queue.find("one")->state, JobState::queued);
  queue.begin("one");
  queue.pause("one");
  queue.resume("one");
  EXPECT_EQ(queue.find("one")->state, JobState::active);
}

TEST(Queue, NeverBeginsWhatIsOver) {
  Queue queue;
  for (const JobState how : {JobState::completed, JobState::failed, JobState::cancelled}) {
    QueuedJob over = job(static_cast<std::uint64_t>(how), "job" + std::to_string(static_cast<int>(how)));
    over.state = how;
    queue.add(over);
  }
  EXPECT_EQ(queue.next(kHungry), std::nullopt);
}

}  // namespace
}  // namespace tessera
