// SPDX-License-Identifier: Apache-2.0
// How long a job takes where one worker is ten times slower than the others, against the ideal: its whole
// cost over the sum of the workers' speeds. A real coordinator over tcp; the workers are simulated (crowd.h)
// and sleep for as long as their tasks would take.
//   straggler_bench [SECONDS of each job, ideally]
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdlib>
#include <numeric>

#include "bench/farm/crowd.h"
#include "coordinator/coordinator.h"
#include "core/plan.h"
#include "proto/clock.h"
#include "proto/zmq_transport.h"

namespace tessera {
namespace {

constexpr double kGoal = 1.15;

Job still() {
  Job job;
  job.scene = {.path = "scene.json", .hash = std::string(64, 'a')};
  job.render.size = {960, 540};
  job.filter = parse_filter("none");
  job.tile = {128, 128};
  job.acceptance.first_samples = job.acceptance.max_samples = 64;
  return job;
}

double cost_of(const Job& job) {
  const std::size_t cells = plan_cells(job).size();
  double cost = 0;
  for (const RenderTask& task :
       plan_render(job, std::vector<int>(cells, 0), first_round(job.acceptance, cells)))
    cost += cost_of(Work(task));
  for (const Tile& tile : plan_tiles(job)) cost += cost_of(Work(FilterTask{tile, 1}));
  return cost;
}

// Several frames: the coordinator knows the workers' speeds from the first one's tasks on.
void line(int fast, double ideal, int frames) {
  const Job job = still();
  const double cost = cost_of(job) * frames, speed = cost / (ideal * (fast + 0.1));
  std::vector<CrowdMember> members(static_cast<std::size_t>(fast), {.speed = speed});
  members.push_back({.speed = 0.1 * speed});
  Crowd crowd(members);
  ZmqContext context;
  ZmqRouter road(context, {"tcp://127.0.0.1:*"});
  Coordinator coordinator(road, {});
  crowd.connect(road.endpoints().front());
  while (coordinator.scheduler().counts().workers < members.size())
    coordinator.turn(clock_now() + Millis{100});
  const auto begin = std::chrono::steady_clock::now();
  coordinator.run({std::vector<Job>(static_cast<std::size_t>(frames), job)}, {});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const SchedulerCounts counts = coordinator.scheduler().counts();
  fmt::print("{:>4} {:>6} {:>8.2f} {:>8.2f} {:>7.3f} {:>7} {:>6} {:>8}\n", fast, frames, ideal, seconds,
             seconds / ideal, counts.accepted, counts.moved, counts.doubled);
}

}  // namespace
}  // namespace tessera

int main(int count, char** words) {
  spdlog::set_level(spdlog::level::warn);
  const double ideal = count > 1 ? std::atof(words[1]) : 10;
  fmt::print(
      "960x540, 64 samples, one worker at a tenth of the others' speed; goal: at most {} of the ideal\n",
      tessera::kGoal);
  fmt::print("{:>4} {:>6} {:>8} {:>8} {:>7} {:>7} {:>6} {:>8}\n", "fast", "frames", "ideal s", "took s",
             "ratio", "tasks", "moved", "doubled");
  for (const int fast : {1, 4, 16})
    for (const int frames : {1, 4}) tessera::line(fast, ideal, frames);
}
