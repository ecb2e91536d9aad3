// SPDX-License-Identifier: Apache-2.0
// How many tasks a second the scheduler alone gives out and takes back, on one core: workers that are done at
// once, with 100,000 tasks waiting all the time; and what a million tasks leave behind in memory.
// usage: scheduler_bench [seconds of each line]
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <deque>
#include <fstream>
#include <string>

#include "coordinator/scheduler.h"

namespace tessera {
namespace {

// Of this thread on its core, whatever else the machine does.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double resident_megabytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

class Farm {
 public:
  Farm(int workers, int flows) : scheduler_(SchedulerOptions{}), flows_(flows) {
    for (int i = 0; i < workers; ++i)
      take(scheduler_.handle(Joined{"w" + std::to_string(i), 2, "cpu", ""}, now_));
  }

  // Tasks of one frame after the other, each of one owner and one scene.
  void fill(std::size_t waiting) {
    while (scheduler_.counts().waiting < waiting) {
      const JobId job = ++jobs_;
      Submitted event{
          {}, {static_cast<std::uint32_t>(job / flows_ % 1000), 0, "owner" + std::to_string(job % flows_)}};
      for (int i = 0; i < 256; ++i) {
        Wish wish{++tasks_, job, 1 << 18};
        wish.scene = "scene" + std::to_string(job % flows_ % 97);
        event.tasks.push_back(std::move(wish));
      }
      take(scheduler_.handle(event, now_));
    }
  }

  // Each answer gives room for a next task. Returns tasks a second.
  double run(double seconds, std::size_t waiting) {
    double passed = 0;
    std::uint64_t done = 0;
    while (passed < seconds) {
      fill(waiting);
      const double from = cpu_seconds();
      for (int i = 0; i < 4096; ++i, ++done) answer();
      passed += cpu_seconds() - from;
    }
    return static_cast<double>(done) / passed;
  }

  std::uint64_t tasks() const { return tasks_; }

 private:
  void answer() {
    const AssignTask task = std::move(given_.front());
    given_.pop_front();
    now_ += std::chrono::microseconds(100);
    take(scheduler_.handle(Done{task.worker, task.task, task.attempt, 0.5}, now_));
  }
  void take(std::vector<Command>&& commands) {
    for (Command& c : commands)
      if (auto* given = std::get_if<AssignTask>(&c)) given_.push_back(std::move(*given));
  }

  Scheduler scheduler_;
  Instant now_{};
  int flows_;
  JobId jobs_ = 0;
  TaskId tasks_ = 0;
  std::deque<AssignTask> given_;
};

void speed(double seconds) {
  fmt::print("{:>8} {:>8} {:>12} {:>16}\n", "workers", "flows", "tasks/s", "decisions/s");
  for (const int flows : {1, 100, 10'000})
    for (const int workers : {1, 100, 10'000}) {
      Farm farm(workers, flows);
      const double rate = farm.run(seconds, 100'000);
      fmt::print("{:>8} {:>8} {:>12.0f} {:>16.0f}\n", workers, flows, rate, 2 * rate);
    }
}

void memory() {
  Farm farm(1000, 10);
  farm.run(0.2, 10'000);
  const double before = resident_megabytes();
  while (farm.tasks() < 1'000'000) farm.run(0.1, 10'000);
  fmt::print("memory after the first tasks {:.1f} MB, after {} tasks {:.1f} MB\n", before, farm.tasks(),
             resident_megabytes());
}

}  // namespace
}  // namespace tessera

int main(int count, char** words) {
  tessera::memory();
  tessera::speed(count > 1 ? std::atof(words[1]) : 1.0);
}
