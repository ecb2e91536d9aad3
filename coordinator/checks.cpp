// SPDX-License-Identifier: Apache-2.0
#include "coordinator/checks.h"

#include <utility>

#include "coordinator/coordinator.h"
#include "proto/clock.h"

namespace tessera {

void Coordinator::check(Check check) {
  const JobId job = next_job_++;
  const TaskId task = next_task_++;
  const Wish wish{.task = task,
                  .job = job,
                  .cost = static_cast<double>(check.work.region.area() * check.work.samples.count()),
                  .scene = check.job.scene.hash,
                  .avoid = check.avoid,
                  .device_class = check.device_class};
  checks_.emplace(task, OpenCheck{job, std::move(check)});
  tell(Submitted{{wish}, {}}, clock_now());
}

bool Coordinator::assign_check(const AssignTask& c) {
  const auto found = checks_.find(c.task);
  if (found == checks_.end()) return false;
  const auto& [job, check] = found->second;
  road_.send(c.worker, JobOffer{job, check.job});
  road_.send(c.worker, Assign{{c.task, job, check.work}, c.attempt, {}});
  return true;
}

bool Coordinator::accept_check(const Accept& c, Instant now) {
  const auto found = checks_.find(c.task);
  if (found == checks_.end()) return false;
  WorkerRecord stranger{.name = in_hand_from_};
  CheckResult result{.worker = in_hand_from_, .name = record_of(in_hand_from_, stranger).name};
  if (auto* render = std::get_if<RenderDone*>(&in_hand_))
    result.digest = digest_of((*render)->block.sums);
  else
    result.failure = "the answer does not fit the task";
  end_check(c.task, result, now);
  return true;
}

bool Coordinator::give_up_check(const GiveUp& c, Instant now) {
  if (!checks_.contains(c.task)) return false;
  end_check(c.task, {.failure = c.reason}, now);
  return true;
}

void Coordinator::end_check(TaskId task, const CheckResult& result, Instant now) {
  const auto ended = checks_.extract(task);
  tell(WithdrawnJob{ended.mapped().job}, now);
  if (!result.worker.empty()) road_.send(result.worker, JobOver{ended.mapped().job});
  ended.mapped().check.told(result);
}

}  // namespace tessera
