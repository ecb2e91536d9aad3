// SPDX-License-Identifier: Apache-2.0
// Storms over farms of many jobs: bands, flows, classes, pauses, poison, workers that are broken. The books
// are checked after every event. See storm_test.cpp for what one job must stand.
#include <gmock/gmock.h>

#include "tests/sim/seeds.h"
#include "tests/sim/storm.h"

namespace tessera::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;

constexpr Instant kEnd = Instant(minutes(10));
constexpr int kUsually = 60;  // seeds in each part

SchedulerOptions quick(int max_attempts) {
  return {.silence = Millis{1500},
          .grace = Millis{600},
          .max_attempts = max_attempts,
          .lease_seconds = 0.2,
          .bytes_ahead = 1000,
          .affinity_slack = 20};
}

Weather weather(std::uint64_t seed, double worst_loss) {
  std::mt19937_64 random(seed);
  const auto up_to = [&random](double most) { return most * static_cast<double>(random() >> 11) * 0x1p-53; };
  return {.seed = seed,
          .loss = up_to(worst_loss),
          .repeat = up_to(worst_loss),
          .delay_min = milliseconds(0),
          .delay_max = milliseconds(static_cast<int>(up_to(200)))};
}

Standing some_standing(Storm& storm) {
  return {static_cast<std::uint32_t>(storm.pick(3)), storm.pick(3),
          std::string(1, static_cast<char>('a' + storm.pick(3)))};
}

// One job: render tasks of one scene, and filter tasks.
Submitted some_job(Storm& storm, JobId job, TaskId first, int tasks) {
  Submitted event{{}, some_standing(storm)};
  const std::string scene(1, static_cast<char>('A' + storm.pick(4)));
  for (int i = 0; i < tasks; ++i) {
    Wish wish{first + i, job, 1.0 + storm.pick(8)};
    wish.filter = storm.pick(3) == 0;
    if (wish.filter)
      wish.bytes = storm.pick(1500);
    else
      wish.scene = scene;
    if (!wish.filter && storm.pick(5) == 0) wish.avoid = "worker-0";
    if (!wish.filter && storm.pick(8) == 0) wish.device_class = "cpu";
    event.tasks.push_back(wish);
  }
  return event;
}

Submitted for_everybody(Submitted event) {
  for (Wish& wish : event.tasks) {
    wish.avoid.clear();
    wish.device_class.clear();
  }
  return event;
}

Habits some_habits(Storm& storm, double break_chance) {
  Habits habits;
  habits.slots = 1 + storm.pick(3);
  habits.break_chance = storm.pick(3) == 0 ? break_chance : 0;
  habits.device_class = storm.pick(2) == 0 ? "cpu" : "gpu";
  habits.name = "host-" + std::to_string(storm.pick(4));
  if (storm.pick(4) == 0) habits.work_max = milliseconds(800);
  return habits;
}

// Pauses and reranks a job now and then; in the end it goes on.
void meddle(Storm& storm, JobId job) {
  Office& office = storm.office();
  for (int i = storm.pick(3); i > 0; --i) {
    const Instant when(milliseconds(storm.pick(1500)));
    storm.at(when, [&office, &storm, job] { office.handle(PausedJob{job}, storm.now()); });
    storm.at(when + milliseconds(storm.pick(1000)),
             [&office, &storm, job] { office.handle(ResumedJob{job}, storm.now()); });
  }
  storm.at(Instant(milliseconds(2600)),
           [&office, &storm, job] { office.handle(ResumedJob{job}, storm.now()); });
  for (int i = storm.pick(3); i > 0; --i)
    storm.at(Instant(milliseconds(storm.pick(1500))), [&office, &storm, job, to = some_standing(storm)] {
      office.handle(Reranked{job, to}, storm.now());
    });
}

class FarmStorms : public Seeds {};
INSTANTIATE_TEST_SUITE_P(Part, FarmStorms, testing::Range(0, kParts));

TEST_P(FarmStorms, EveryTaskOfEveryJobIsAcceptedExactlyOnce) {
  for_each_seed(kUsually, [](std::uint64_t seed) {
    Storm storm(seed, weather(seed, 0.3), quick(1'000'000));
    Office& office = storm.office();
    office.audited = true;
    // Those that live; one does what the other must not.
    storm.hire({.slots = 1 + storm.pick(2), .device_class = "cpu"});
    storm.hire({.slots = 1 + storm.pick(2), .device_class = "cpu"});
    for (int i = storm.pick(4); i > 0; --i) {
      Habits habits = some_habits(storm, 1.0);
      habits.death = static_cast<Death>(storm.pick(kDeaths));
      storm.hire(habits);
    }
    int deaths = 0;
    storm.replace_the_dead_by([&] {
      Habits habits = some_habits(storm, 0.5);
      if (++deaths < 8) habits.death = static_cast<Death>(storm.pick(kDeaths));
      return habits;
    });
    TaskId next = 1;
    for (JobId job = 1; job <= static_cast<JobId>(1 + storm.pick(4)); ++job) {
      const int tasks = 1 + storm.pick(15);
      storm.at(Instant(milliseconds(storm.pick(1500))),
               [&office, &storm, event = some_job(storm, job, next, tasks)] {
                 office.submit(event, storm.now());
               });
      meddle(storm, job);
      next += tasks;
    }
    // Somebody gives those that were set aside another chance, again and again.
    for (int i = 1; i < 300; ++i)
      storm.at(Instant(milliseconds(2000 * i)), [&office, &storm] {
        for (const std::string& name : office.set_aside) office.handle(Released{name}, storm.now());
      });
    ASSERT_TRUE(storm.run([&] { return office.accepted.size() == next - 1; }, kEnd))
        << next - 1 - office.accepted.size() << " tasks are never done";
    EXPECT_TRUE(office.given_up.empty());
    EXPECT_EQ(office.scheduler().counts().waiting + office.scheduler().counts().running, 0u);
    EXPECT_EQ(office.scheduler().counts().accepted, next - 1);
  });
}

// Up to two workers fail at everything, some tasks fail everywhere: neither is taken for the other.
TEST_P(FarmStorms, PoisonIsGivenUpBrokenWorkersAreSetAsideAndNothingElse) {
  for_each_seed(kUsually, [](std::uint64_t seed) {
    Storm storm(seed, {.seed = seed, .delay_min = milliseconds(1), .delay_max = milliseconds(9)}, quick(3));
    Office& office = storm.office();
    office.audited = true;
    const int poison = 2 + storm.pick(12);  // each so manyeth task
    const auto is_poison = [poison](TaskId id) { return id % poison == 0; };
    const int good = 2 + storm.pick(4), broken = storm.pick(3);
    for (int i = 0; i < good; ++i)
      storm.hire({.slots = 1 + storm.pick(3), .breaks = is_poison, .name = "good-" + std::to_string(i)});
    for (int i = 0; i < broken; ++i)
      storm.hire({.slots = 1 + storm.pick(3),
                  .break_chance = 1,
                  .work_max = milliseconds(20),
                  .name = "broken-" + std::to_string(i)});
    TaskId next = 1;
    for (JobId job = 1; job <= 3; ++job, next += 20) {
      const Submitted event = for_everybody(some_job(storm, job, next, 20));
      storm.at(Instant(milliseconds(storm.pick(300))),
               [&office, &storm, event] { office.submit(event, storm.now()); });
    }
    ASSERT_TRUE(storm.run([&] { return office.accepted.size() + office.given_up.size() == next - 1; }, kEnd));
    for (TaskId id = 1; id < next; ++id) EXPECT_EQ(office.given_up.contains(id), is_poison(id)) << id;
    for (const std::string& name : office.set_aside) EXPECT_EQ(name.substr(0, 6), "broken") << name;
  });
}

// A worker that fails at everything comes back under new ids, and is set aside all the same.
TEST_P(FarmStorms, AWorkerThatFailsAtEverythingIsSetAsideAndStaysSo) {
  for_each_seed(kUsually / 4, [](std::uint64_t seed) {
    Storm storm(seed, {.seed = seed, .delay_min = milliseconds(1), .delay_max = milliseconds(9)}, quick(3));
    Office& office = storm.office();
    office.audited = true;
    storm.hire({.slots = 1 + storm.pick(3)});
    storm.hire({.break_chance = 1, .work_max = milliseconds(5), .name = "broken"});
    office.submit(for_everybody(some_job(storm, 1, 1, 1)), storm.now());
    for (int i = 1; i < 4; ++i)
      storm.at(Instant(milliseconds(3000 * i)), [&storm, &office, i] {
        storm.hire({.break_chance = 1, .work_max = milliseconds(5), .name = "broken"});
        office.submit(for_everybody(some_job(storm, 1, 100 * i, 40)), storm.now());
      });
    ASSERT_TRUE(
        storm.run([&] { return storm.now() > Instant(milliseconds(12000)) && office.open() <= 1; }, kEnd));
    EXPECT_THAT(office.set_aside, testing::ElementsAre("broken"));
    EXPECT_EQ(office.scheduler().counts().set_aside, 1u);
    for (const WorkerFigures& w : office.scheduler().workers())
      EXPECT_EQ(w.name == "broken", !w.set_aside.empty()) << w.worker;
    EXPECT_LE(office.scheduler().counts().retried, 40u) << "it goes on being given tasks, of 121";
  });
}

}  // namespace
}  // namespace tessera::sim
