// SPDX-License-Identifier: Apache-2.0
// A worker: the loop that carries out what its Agent decides, and the threads of its slots.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "core/image.h"
#include "core/job.h"
#include "core/task.h"
#include "proto/transport.h"
#include "worker/agent.h"

namespace tessera {

// What a slot does with a task. Called from all slots at once.
class TaskRunner {
 public:
  virtual ~TaskRunner() = default;
  // The result; task, attempt and seconds are filled in by others. When `cancel` becomes true it should
  // throw, anything, and soon. Any other exception fails the task; Error(bad_input) says that no worker will
  // ever succeed.
  virtual TaskResult run(const Job& job, const Task& task, const FilterInput& input,
                         const std::atomic<bool>& cancel) = 0;
};

// How a worker's life ended.
struct WorkerEnd {
  Farewell why = Farewell::asked;
  std::string reason;
};

class Worker {
 public:
  // Both are borrowed and outlive the worker.
  Worker(AgentOptions options, Transport& road, TaskRunner& runner);
  ~Worker();

  // Works until stop(), or until the coordinator refuses it or is silent for AgentOptions::give_up. Call
  // once.
  WorkerEnd run();
  // From any thread, or a signal handler if Transport::wake may be called there: take no more tasks, give
  // back what is in hand, leave.
  void stop();

 private:
  class Slots;
  void carry_out(Agent::Command&& command);

  Transport& road_;
  Agent agent_;
  std::unique_ptr<Slots> slots_;
  std::atomic<bool> stop_ = false;
  std::optional<WorkerEnd> end_;
};

}  // namespace tessera
