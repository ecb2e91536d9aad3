// SPDX-License-Identifier: Apache-2.0
// Whole workers in threads around one scheduler, over every road there is.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <thread>

#include "core/error.h"
#include "proto/clock.h"
#include "proto/memory_transport.h"
#include "proto/zmq_transport.h"
#include "tests/sim/office.h"
#include "worker/worker.h"

namespace tessera::sim {
namespace {

class RightRunner : public TaskRunner {
 public:
  TaskResult run(const Job&, const Task& task, const FilterInput&, const std::atomic<bool>&) override {
    return right_answer(task);
  }
};

// One that fails its first task, breaks down on every seventh, and waits to be cancelled where it is told to.
class MoodyRunner : public TaskRunner {
 public:
  TaskResult run(const Job&, const Task& task, const FilterInput&, const std::atomic<bool>& cancel) override {
    const int n = calls_++;
    if (n % 7 == 0) throw std::runtime_error("a bad day");
    if (task.id == stuck) {
      while (!cancel) std::this_thread::yield();
      throw n;
    }
    return right_answer(task);
  }
  std::atomic<TaskId> stuck = 0;

 private:
  std::atomic<int> calls_ = 0;
};

std::string socket_file() {
  const char* folder = std::getenv("TMPDIR");
  return "ipc://" + std::filesystem::path(folder ? folder : "/tmp").string() + "/tessera-farm-" +
         std::to_string(getpid());
}

std::vector<Task> tasks(TaskId first, TaskId last) {
  std::vector<Task> all;
  for (TaskId id = first; id < last; ++id) all.push_back(task_of(id));
  return all;
}

const AgentOptions kQuick{.slots = 2, .version = "test", .hello_first = Millis{5}, .hello_last = Millis{50}};

// A worker in a thread of its own, at work until it is destroyed.
class Hired {
 public:
  Hired(std::unique_ptr<Transport> road, TaskRunner& runner, const AgentOptions& options = kQuick)
      : road_(std::move(road)), worker_(options, *road_, runner), thread_([this] { end = worker_.run(); }) {}
  ~Hired() { stop(); }
  void stop() {
    if (!thread_.joinable()) return;
    worker_.stop();
    thread_.join();
  }
  WorkerEnd end;

 private:
  std::unique_ptr<Transport> road_;
  Worker worker_;
  std::jthread thread_;
};

void run_until_done(Office& office, Transport& road) {
  const Instant patience = clock_now() + std::chrono::seconds(60);
  while (office.open() > 0) {
    ASSERT_LT(clock_now(), patience) << office.open() << " tasks are left";
    const Instant until = std::min(office.scheduler().next_deadline().value_or(patience), patience);
    if (auto mail = road.receive(until)) office.hear(std::move(*mail), clock_now());
    office.turn(clock_now());
  }
}

class Farm : public testing::TestWithParam<std::string> {
 protected:
  Farm() : router(context, {GetParam() == "ipc" ? socket_file() : GetParam()}) {}
  std::unique_ptr<Transport> road_of(const WorkerId& id) {
    return std::make_unique<ZmqDealer>(context, router.endpoints()[0], id);
  }
  ZmqContext context;
  ZmqRouter router;
  Office office{router, {}, Millis{50}};
};
INSTANTIATE_TEST_SUITE_P(, Farm, testing::Values("inproc://farm", "ipc", "tcp://127.0.0.1:*"),
                         [](const auto& road) { return road.param.substr(0, road.param.find(':')); });

TEST_P(Farm, EveryTaskIsDoneOnceByAnyNumberOfWorkers) {
  RightRunner runner;
  for (int workers = 1; workers <= 3; ++workers) {
    std::vector<std::unique_ptr<Hired>> hired;
    for (int i = 0; i < workers; ++i)
      hired.push_back(
          std::make_unique<Hired>(road_of(std::to_string(workers) + "-" + std::to_string(i)), runner));
    office.submit(tasks(workers * 1000, workers * 1000 + 200), clock_now());
    run_until_done(office, router);
    EXPECT_EQ(office.accepted.size(), 200u * workers);
  }
  EXPECT_TRUE(office.given_up.empty());
}

TEST_P(Farm, TasksThatFailAreDoneElsewhere) {
  MoodyRunner moody;
  RightRunner right;
  Hired a(road_of("moody"), moody), b(road_of("right"), right);
  office.submit(tasks(1, 300), clock_now());
  run_until_done(office, router);
  EXPECT_EQ(office.accepted.size(), 299u);
}

TEST_P(Farm, AWorkerThatHangsHoldsUpNobodyAndIsRevoked) {
  MoodyRunner moody;
  RightRunner right;
  moody.stuck = 5;
  Hired a(road_of("moody"), moody), b(road_of("right"), right);
  office.submit(tasks(1, 50), clock_now());
  run_until_done(office, router);
  EXPECT_EQ(office.accepted.size(), 49u);
}

TEST_P(Farm, AWorkerThatIsStoppedSaysGoodbye) {
  MoodyRunner moody;
  moody.stuck = 3;
  Hired first(road_of("first"), moody, {.slots = 1, .hello_first = Millis{5}});
  office.submit(tasks(3, 4), clock_now());
  while (office.assigned == 0)
    if (auto mail = router.receive(clock_now() + Millis{100})) office.hear(std::move(*mail), clock_now());
  first.stop();
  EXPECT_EQ(first.end.why, Farewell::asked);
  RightRunner right;
  Hired second(road_of("second"), right);
  const Instant begin = clock_now();
  run_until_done(office, router);
  EXPECT_LT(clock_now() - begin, SchedulerOptions{}.silence);
  EXPECT_TRUE(office.forgotten.empty());
}

TEST(Worker, StopsWhenNoCoordinatorAnswers) {
  MemoryRoad road({});
  RightRunner runner;
  const auto end = road.join("lonely");
  Worker worker({.hello_first = Millis{1}, .give_up = Millis{20}}, *end, runner);
  EXPECT_EQ(worker.run().why, Farewell::unreachable);
}

TEST(Worker, StopsWhenItIsRefusedAndSaysWhy) {
  MemoryRoad road({});
  RightRunner runner;
  const auto office = road.join("coordinator"), end = road.join("old");
  office->send("old", Refused{"too old"});
  Worker worker({}, *end, runner);
  const WorkerEnd last = worker.run();
  EXPECT_EQ(last.why, Farewell::refused);
  EXPECT_EQ(last.reason, "too old");
}

class WrongInputRunner : public TaskRunner {
 public:
  TaskResult run(const Job&, const Task& task, const FilterInput&, const std::atomic<bool>&) override {
    if (task.id % 2 == 0) throw InputError("scene.json:7", "no such thing", "a thing");
    throw std::bad_alloc();
  }
};

TEST(Worker, WhatATaskThrowsBecomesAMessage) {
  MemoryRoad road({});
  WrongInputRunner runner;
  const auto end = road.join("coordinator");
  Office office(*end, {.max_attempts = 2}, Millis{50});
  Hired worker(road.join("worker"), runner);
  office.submit(tasks(1, 3), clock_now());
  run_until_done(office, *end);
  EXPECT_EQ(office.given_up.at(2), (GiveUp{2, "scene.json:7: no such thing; accepted: a thing", true}));
  EXPECT_EQ(office.given_up.at(1), (GiveUp{1, "out of memory", false}));
}

// Threads and real time over a road that loses, delays, repeats and reorders.
TEST(Worker, WholeWorkersGetEverythingDoneInBadWeather) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(seed);
    MemoryRoad road({.seed = seed, .loss = 0.15, .repeat = 0.15, .delay_max = Millis{4}});
    RightRunner runner;
    const auto end = road.join("coordinator");
    Office office(*end, {.silence = Millis{300}, .grace = Millis{30}, .max_attempts = 1000}, Millis{10});
    const AgentOptions options{.slots = 2, .hello_first = Millis{5}, .hello_last = Millis{20}};
    Hired a(road.join("a"), runner, options), b(road.join("b"), runner, options);
    office.submit(tasks(1, 60), clock_now());
    run_until_done(office, *end);
    EXPECT_EQ(office.accepted.size(), 59u);
  }
}

}  // namespace
}  // namespace tessera::sim
