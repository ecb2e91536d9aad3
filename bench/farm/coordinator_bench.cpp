// SPDX-License-Identifier: Apache-2.0
// What the coordinator alone can do, over real connections (tcp, this machine), with workers that answer at
// once (crowd.h): tasks a second given out and taken back, its processor time for each, its memory, and what
// it costs to be connected to workers that have nothing to do. The crowd wants the processor too, so where
// there are few cores the processor time of a task is the figure to go by.
//   coordinator_bench [TASKS of each line, and five times as many for the memory [alone|store|memory|idle
//   ...]]
#include <fmt/format.h>
#include <malloc.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "bench/farm/crowd.h"
#include "coordinator/farm/farm.h"
#include "core/bundle.h"
#include "proto/clock.h"
#include "proto/submission_codec.h"
#include "proto/zmq_transport.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr double kGoal = 20'000;           // tasks a second
constexpr double kGoalIdle = 0.01;         // of a core
constexpr int kEdge = 8, kSamples = 4096;  // of a frame: 64 pixels of 512 tasks each
constexpr std::uint64_t kTasksAFrame = kEdge * kEdge * (kSamples / kLeafSamples + 1);

double seconds_on(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Spent {
  double wall = seconds_on(CLOCK_MONOTONIC), thread = seconds_on(CLOCK_THREAD_CPUTIME_ID),
         process = seconds_on(CLOCK_PROCESS_CPUTIME_ID);
  Spent since(const Spent& begin) const {
    return {wall - begin.wall, thread - begin.thread, process - begin.process};
  }
};

double resident_megabytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

// Of the heap, in use. What is resident follows the most that ever was.
double in_use_megabytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd) / 1e6;
}

// Tasks of one pixel and eight samples; a tile of one pixel is filtered (with nothing) for every 512 of them.
Job small_tasks() {
  Job job;
  job.scene = {.path = "scene.json", .hash = std::string(64, 'a')};
  job.render.size = {kEdge, kEdge};
  job.filter = parse_filter("none");
  job.tile = {1, 1};
  job.task_samples = 1;
  job.acceptance.first_samples = job.acceptance.max_samples = kSamples;
  return job;
}

// A road that many may speak over as fast as they can.
ZmqOptions wide_road() {
  ZmqOptions options{.high_water = 1'000'000};
  options.limits.worker = {.messages = 1e9, .bytes = 1e12, .message_burst = 1e9, .byte_burst = 1e12};
  return options;
}

// What a line is measured on: a coordinator by itself, or a farm with its store.
struct Centre {
  std::function<void(Instant)> turn;
  std::function<const Coordinator&()> coordinator;
  std::function<bool()> over;
};

struct Line {
  Spent spent;
  std::uint64_t tasks = 0;
  double resident_middle = 0, resident_end = 0;  // MB
  // The least in use in each half: between frames, when few tasks wait.
  double least_early = 1e9, least_late = 1e9;
};

void gather(const Centre& centre, std::size_t workers) {
  const Instant late = clock_now() + std::chrono::seconds(120);
  while (centre.coordinator().scheduler().counts().workers < workers) {
    centre.turn(clock_now() + Millis{100});
    if (clock_now() > late) throw std::runtime_error("the workers do not come");
  }
}

Line measure(const Centre& centre, std::uint64_t tasks) {
  const auto accepted = [&] { return centre.coordinator().scheduler().counts().accepted; };
  const auto until = [&](std::uint64_t n, double* least) {
    for (std::uint64_t next = accepted(); accepted() < n && !centre.over();) {
      centre.turn(clock_now() + Millis{100});
      if (!least || accepted() < next) continue;
      *least = std::min(*least, in_use_megabytes());
      next = accepted() + 500;
    }
  };
  Line line;
  until(tasks / 20, nullptr);  // not the beginning
  const std::uint64_t from = accepted();
  const Spent begin;
  until(tasks / 2, &line.least_early);
  line.resident_middle = resident_megabytes();
  until(tasks, &line.least_late);
  line.spent = Spent().since(begin);
  line.tasks = accepted() - from;
  line.resident_end = resident_megabytes();
  return line;
}

std::vector<CrowdMember> crowd_of(int workers) {
  // Each says what it would take if all together just did what is the goal.
  return std::vector<CrowdMember>(static_cast<std::size_t>(workers), {.says = workers / kGoal});
}

Line alone(int workers, std::uint64_t tasks) {
  Crowd crowd(crowd_of(workers));
  ZmqContext context;
  ZmqRouter road(context, {"tcp://127.0.0.1:*"}, wide_road());
  Coordinator coordinator(road, {});
  const Centre centre{[&](Instant until) { coordinator.turn(until); },
                      [&]() -> const Coordinator& { return coordinator; }, [] { return false; }};
  crowd.connect(road.endpoints().front());
  gather(centre, static_cast<std::size_t>(workers));
  coordinator.begin({std::vector<Job>(tasks / kTasksAFrame + 2, small_tasks())}, {}, {});
  return measure(centre, tasks);
}

Submission submission_of(std::uint64_t frames, const Digest& bundle) {
  Submission s{.name = "small tasks", .job = small_tasks()};
  s.job.scene.bundle = bundle;
  for (std::uint64_t i = 0; i < frames; ++i) s.frames.push_back(static_cast<int>(i));
  return s;
}

Line with_store(int workers, std::uint64_t tasks) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("coordinator_bench.{}", getpid());
  Line line;
  {
    Crowd crowd(crowd_of(workers));
    ZmqContext context;
    ZmqRouter road(context, {"tcp://127.0.0.1:*"}, wide_road());
    FarmOptions options;
    options.store = folder;
    options.memory = 1e9;
    options.version = "0";
    Farm farm(road, options);
    const Centre centre{[&](Instant until) { farm.turn(until); },
                        [&]() -> const Coordinator& { return farm.coordinator(); },
                        [&] { return !farm.trouble().empty(); }};
    crowd.connect(road.endpoints().front());
    gather(centre, static_cast<std::size_t>(workers));
    BlobStore& blobs = farm.store().blobs();
    const Bundle bundle{"scene.json", {{"scene.json", blobs.put("{}"), 2}}};
    const Submission s = submission_of(tasks / kTasksAFrame + 2, blobs.put(to_text(bundle)));
    farm.submit("small", blobs.put(encode(s)), "bench", kHighestPriority);
    line = measure(centre, tasks);
    if (!farm.trouble().empty()) throw std::runtime_error(farm.trouble());
  }
  fs::remove_all(folder);
  return line;
}

void print(int workers, const char* store, const Line& l) {
  const auto n = static_cast<double>(l.tasks);
  const double thread = 1e6 * l.spent.thread / n;
  fmt::print("{:>7}  {:<5} {:>8} {:>11.0f} {:>12.1f} {:>13.1f} {:>14.0f} {:>8.2f}\n", workers, store, l.tasks,
             n / l.spent.wall, thread, 1e6 * l.spent.process / n, 1e6 / thread, 1e6 / thread / kGoal);
}

void memory(int workers, std::uint64_t tasks) {
  const Line l = alone(workers, tasks);
  print(workers, "no", l);
  fmt::print(
      "memory: resident {:.1f} MB half-way, {:.1f} MB at the end ({:.3f}); in use between frames {:.1f} MB "
      "in the"
      " first half, {:.1f} MB in the second; goal: flat\n",
      l.resident_middle, l.resident_end, l.resident_end / l.resident_middle, l.least_early, l.least_late);
}

void idle(int workers) {
  Crowd crowd(crowd_of(workers));
  ZmqContext context;
  ZmqRouter road(context, {"tcp://127.0.0.1:*"}, wide_road());
  Coordinator coordinator(road, {});
  const Centre centre{[&](Instant until) { coordinator.turn(until); },
                      [&]() -> const Coordinator& { return coordinator; }, [] { return false; }};
  crowd.connect(road.endpoints().front());
  gather(centre, static_cast<std::size_t>(workers));
  const Spent begin;
  while (Spent().since(begin).wall < 70) coordinator.turn(clock_now() + Millis{100});
  const Spent spent = Spent().since(begin);
  fmt::print(
      "{} workers idle, for 70 s: {:.2f} % of a core, of it the coordinator's thread {:.2f}"
      " %; goal: below {:.0f} %\n",
      workers, 100 * spent.process / spent.wall, 100 * spent.thread / spent.wall, 100 * kGoalIdle);
}

void run(std::uint64_t tasks, const std::set<std::string>& parts) {
  const auto wanted = [&](const char* part) { return parts.empty() || parts.contains(part); };
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
  fmt::print("{:>7}  {:<5} {:>8} {:>11} {:>12} {:>13} {:>14} {:>8}\n", "workers", "store", "tasks", "tasks/s",
             "us/task", "us, with I/O", "tasks/s, core", "of goal");
  for (const int workers : {1, 100, 1000})
    if (wanted("alone")) print(workers, "no", alone(workers, tasks));
  for (const int workers : {1, 100, 1000})
    if (wanted("store")) print(workers, "yes", with_store(workers, tasks));
  for (const int workers : {100, 1000})
    if (wanted("memory")) memory(workers, 5 * tasks);
  if (wanted("idle")) idle(1000);
}

}  // namespace
}  // namespace tessera

int main(int count, char** words) {
  spdlog::set_level(spdlog::level::warn);
  try {
    tessera::run(count > 1 ? std::strtoull(words[1], nullptr, 10) : 200'000,
                 {words + std::min(2, count), words + count});
  } catch (const std::exception& e) {
    fmt::print(stderr, "coordinator_bench: {}\n", e.what());
    return 1;
  }
}
