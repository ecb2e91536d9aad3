// SPDX-License-Identifier: Apache-2.0
// Thousands of small farms in bad weather. A failure prints the seed that makes it again.
#include <gmock/gmock.h>

#include "tests/sim/seeds.h"
#include "tests/sim/storm.h"

namespace tessera::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr SchedulerOptions kQuick{.silence = Millis{1500}, .grace = Millis{600}, .max_attempts = 1'000'000};
constexpr Instant kEnd = Instant(minutes(10));

Weather bad_weather(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto up_to = [&random](double most) { return most * static_cast<double>(random() >> 11) * 0x1p-53; };
  return {.seed = seed,
          .loss = up_to(0.35),
          .repeat = up_to(0.35),
          .delay_min = milliseconds(0),
          .delay_max = milliseconds(static_cast<int>(up_to(300)))};
}

Habits some_habits(Storm& storm) {
  Habits habits;
  habits.slots = 1 + storm.pick(3);
  habits.death = static_cast<Death>(storm.pick(kDeaths));
  habits.break_chance = storm.pick(3) == 0 ? 0.2 : 0;
  if (storm.pick(4) == 0) habits.work_max = seconds(2);
  return habits;
}

std::vector<Task> tasks(TaskId first, TaskId last) {
  std::vector<Task> all;
  for (TaskId id = first; id < last; ++id) all.push_back(task_of(id, 1 + id % 2));
  return all;
}

constexpr int kUsually = 250;  // seeds in each part
class Storms : public Seeds {};
INSTANTIATE_TEST_SUITE_P(Part, Storms, testing::Range(0, kParts));

TEST_P(Storms, EveryTaskIsAcceptedExactlyOnceWhoeverDiesAndWhateverIsLost) {
  for_each_seed(kUsually, [](std::uint64_t seed) {
    Storm storm(seed, bad_weather(seed), kQuick);
    const TaskId last = 2 + storm.pick(60);
    storm.hire({.slots = 1 + storm.pick(2)});  // one that lives, or nothing could be promised
    // One may hang for ever, talking; a task that hangs on two workers has both its copies there.
    if (storm.pick(3) == 0) storm.hire({.slots = 1 + storm.pick(3), .hangs = true});
    for (int i = storm.pick(4); i > 0; --i) storm.hire(some_habits(storm));
    int deaths = 0;
    storm.replace_the_dead_by([&] { return ++deaths < 10 ? some_habits(storm) : Habits{}; });
    storm.office().submit(tasks(1, last), storm.now());
    ASSERT_TRUE(storm.run([&] { return storm.office().open() == 0; }, kEnd))
        << storm.office().open() << " tasks are never done";
    EXPECT_EQ(storm.office().accepted.size(), last - 1);
    EXPECT_TRUE(storm.office().given_up.empty());
    // What is not wanted any more is let go, though every word of it may be lost.
    storm.office().closed = true;
    EXPECT_TRUE(storm.run([&] { return !storm.anyone_at_work(); }, kEnd)) << "somebody works for nothing";
  });
}

TEST_P(Storms, WorkComesInRoundsIsWithdrawnAndWorkersComeAndGo) {
  for_each_seed(kUsually, [](std::uint64_t seed) {
    Storm storm(seed, bad_weather(seed), kQuick);
    storm.hire({.slots = 2});
    for (int i = 0; i < 3; ++i) {
      storm.at(Instant(milliseconds(storm.pick(3000))), [&storm] {
        Actor& comer = storm.hire({.slots = 1 + storm.pick(3)});
        storm.at(storm.now() + milliseconds(storm.pick(2000)), [&comer, &storm] { comer.stop(storm.now()); });
      });
    }
    std::set<TaskId> withdrawn;
    constexpr int rounds = 4, round = 15;
    for (int r = 0; r < rounds; ++r) {
      const TaskId first = r * round + 1;
      storm.at(Instant(milliseconds(r * 400)),
               [&storm, first] { storm.office().submit(tasks(first, first + round), storm.now()); });
      storm.at(Instant(milliseconds(r * 400 + storm.pick(300))), [&storm, &withdrawn, first] {
        for (TaskId id = first + 3; id < first + 6; ++id)
          if (!storm.office().accepted.contains(id)) withdrawn.insert(id);
        storm.office().withdraw({withdrawn.begin(), withdrawn.end()}, storm.now());
      });
    }
    ASSERT_TRUE(
        storm.run([&] { return storm.now() > Instant(seconds(2)) && storm.office().open() == 0; }, kEnd));
    EXPECT_EQ(storm.office().accepted.size() + withdrawn.size(), TaskId{rounds * round});
  });
}

TEST_P(Storms, TasksThatAlwaysFailAreGivenUpAndOnlyThose) {
  for_each_seed(kUsually, [](std::uint64_t seed) {
    SchedulerOptions options = kQuick;
    options.max_attempts = 3;
    Storm storm(seed, bad_weather(seed), options);
    const auto is_poison = [](TaskId id) { return id % 5 == 0; };
    for (int i = 1 + storm.pick(4); i > 0; --i) storm.hire({.slots = 1 + storm.pick(2), .breaks = is_poison});
    storm.office().submit(tasks(1, 31), storm.now());
    ASSERT_TRUE(storm.run([&] { return storm.office().open() == 0; }, kEnd));
    for (TaskId id = 5; id < 31; id += 5) EXPECT_TRUE(storm.office().given_up.contains(id)) << id;
    // In weather this bad a worker may be thought dead; a healthy task is not given up for failing.
    for (const auto& [id, why] : storm.office().given_up)
      EXPECT_TRUE(is_poison(id) || why.reason.find("fell silent") != std::string::npos) << id << why.reason;
  });
}

TEST_P(Storms, TasksThatKillTheirWorkersAreGivenUpAndOnlyThose) {
  for_each_seed(kUsually, [](std::uint64_t seed) {
    SchedulerOptions options = kQuick;
    options.max_attempts = 3;
    options.endgame = false;
    Storm storm(seed, {.seed = seed, .delay_min = milliseconds(5), .delay_max = milliseconds(5)}, options);
    const auto kills = [](TaskId id) { return id == 7 || id == 16; };
    const auto victim = [&kills] { return Habits{.kills = kills}; };
    for (int i = 1 + storm.pick(4); i > 0; --i) storm.hire(victim());
    storm.replace_the_dead_by(victim);
    // Of one job: a worker begins with the tasks whose job it knows, and the wrong one would be blamed.
    std::vector<Task> all;
    for (TaskId id = 1; id < 31; ++id) all.push_back(task_of(id));
    storm.office().submit(all, storm.now());
    ASSERT_TRUE(storm.run([&] { return storm.office().open() == 0; }, kEnd));
    EXPECT_EQ(storm.office().accepted.size(), 28u);
    EXPECT_EQ(storm.office().forgotten.size(), 6u) << "each took three lives";
    EXPECT_TRUE(storm.office().given_up.contains(7) && storm.office().given_up.contains(16));
  });
}

TEST(Storm, TheSameSeedMakesTheSameStorm) {
  const auto story = [](std::uint64_t seed) {
    Storm storm(seed, bad_weather(seed), kQuick);
    storm.hire({});
    for (int i = 0; i < 3; ++i) storm.hire(some_habits(storm));
    storm.office().submit(tasks(1, 40), storm.now());
    storm.run([&] { return storm.office().open() == 0; }, kEnd);
    const MemoryRoad::Counts counts = storm.road().counts();
    return std::tuple(storm.now(), storm.office().assigned, counts.sent, counts.lost, counts.received);
  };
  for (std::uint64_t seed = 0; seed < 20; ++seed) EXPECT_EQ(story(seed), story(seed));
  EXPECT_NE(story(1), story(2));
}

// What the storms would not show: that the repairs are prompt where the weather is good.
TEST(Storm, InFairWeatherNothingIsDoneTwiceBeforeTheEnd) {
  SchedulerOptions options = kQuick;
  options.endgame = false;
  Storm storm(1, {.delay_min = milliseconds(5), .delay_max = milliseconds(5)}, options);
  for (int i = 0; i < 5; ++i) storm.hire({.slots = 2});
  storm.office().submit(tasks(1, 1001), storm.now());
  ASSERT_TRUE(storm.run([&] { return storm.office().open() == 0; }, kEnd));
  EXPECT_EQ(storm.office().assigned, 1000u);
  EXPECT_EQ(storm.office().revoked, 0u);
}

TEST(Storm, ASlowWorkerDoesNotHoldUpTheEnd) {
  Storm storm(1, {.delay_min = milliseconds(5), .delay_max = milliseconds(5)}, kQuick);
  storm.hire({.work_min = minutes(5), .work_max = minutes(5)});
  storm.hire({.work_min = milliseconds(50), .work_max = milliseconds(50)});
  storm.office().submit(tasks(1, 21), storm.now());
  ASSERT_TRUE(storm.run([&] { return storm.office().open() == 0; }, kEnd));
  EXPECT_LT(storm.now(), Instant(seconds(3)));
}

}  // namespace
}  // namespace tessera::sim
