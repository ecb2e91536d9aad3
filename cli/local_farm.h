// SPDX-License-Identifier: Apache-2.0
// A whole farm in this process: a coordinator, and a worker with a slot per thread, over inproc. Nothing in
// either knows that the other is near.
#pragma once

#include <memory>
#include <string>
#include <thread>

#include "coordinator/coordinator.h"
#include "proto/zmq_transport.h"
#include "worker/task_runner.h"

namespace tessera {

class LocalFarm {
 public:
  // `device` as Device::open takes it. Throws Error(no_device).
  LocalFarm(std::shared_ptr<const Scene> scene, int threads, const std::string& device,
            const TextureOptions& textures = {});
  ~LocalFarm();

  Coordinator& coordinator() { return coordinator_; }

 private:
  LocalFarm(std::shared_ptr<const Scene> scene, int threads, DevicePool devices,
            const TextureOptions& textures);
  void work();

  ZmqContext context_;
  ZmqRouter router_;
  Coordinator coordinator_;
  ZmqDealer dealer_;
  std::string device_class_;
  std::unique_ptr<TaskRunner> runner_;
  Worker worker_;
  std::jthread thread_;
};

// The threads this process may use: SLURM_CPUS_PER_TASK, CUE_THREADS, the CPU set and the cgroup's quota are
// kept.
int usable_threads();

}  // namespace tessera
