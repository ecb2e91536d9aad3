// SPDX-License-Identifier: Apache-2.0
#include "cli/local_farm.h"

#include <fmt/format.h>
#include <sched.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "cli/version.h"

namespace tessera {
namespace {

constexpr const char* kEndpoint = "inproc://farm";

int cores_of_this_process() {
  cpu_set_t set;
  CPU_ZERO(&set);
  return sched_getaffinity(0, sizeof set, &set) == 0 ? std::max(1, CPU_COUNT(&set)) : 1;
}

// cgroup v2: "max 100000" or "150000 100000": microseconds of CPU in each period.
int cores_of_the_cgroup() {
  std::ifstream file("/sys/fs/cgroup/cpu.max");
  double quota = 0, period = 0;
  if (!(file >> quota >> period) || period <= 0) return 1 << 16;
  return std::max(1, static_cast<int>(std::floor(quota / period)));
}

int granted_by(const char* variable) {
  const char* value = std::getenv(variable);
  const int n = value != nullptr ? std::atoi(value) : 0;
  return n > 0 ? n : 1 << 16;
}

// Mail that is no message would be a bug here, where nobody else speaks.
ZmqOptions loud(const char* end) {
  ZmqOptions options;
  options.on_dropped = [end](std::string_view why) {
    spdlog::error("{}: a message was dropped: {}", end, why);
  };
  return options;
}

}  // namespace

int usable_threads() {
  return std::min({cores_of_this_process(), cores_of_the_cgroup(), granted_by("SLURM_CPUS_PER_TASK"),
                   granted_by("CUE_THREADS")});
}

LocalFarm::LocalFarm(std::shared_ptr<const Scene> scene, int threads, const std::string& device,
                     const TextureOptions& textures)
    : LocalFarm(std::move(scene), threads, DevicePool::open({device}), textures) {}

LocalFarm::LocalFarm(std::shared_ptr<const Scene> scene, int threads, DevicePool devices,
                     const TextureOptions& textures)
    : router_(context_, {kEndpoint}, loud("coordinator")),
      coordinator_(router_, {}),
      dealer_(context_, kEndpoint, "local", loud("worker")),
      device_class_(device_class(std::string(kVersion), devices.infos())),
      runner_(make_task_runner(scene_in_hand(std::move(scene)), std::move(devices), 2, textures)),
      worker_({.slots = threads, .version = std::string(kVersion), .device_class = device_class_}, dealer_,
              *runner_),
      thread_([this] { work(); }) {}

// A farm without its only worker would wait for ever.
void LocalFarm::work() {
  std::string why = "the worker ended";
  try {
    const WorkerEnd end = worker_.run();
    if (end.why == Farewell::asked) return;
    why += fmt::format(": {}", end.reason);
  } catch (const std::exception& e) {
    why += fmt::format(": {}", e.what());
  }
  coordinator_.fail(why);
}

LocalFarm::~LocalFarm() {
  worker_.stop();
  thread_.join();
}

}  // namespace tessera
