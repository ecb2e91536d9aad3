// SPDX-License-Identifier: Apache-2.0
// Work that was accepted is done again elsewhere, and its bits are compared.
#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "coordinator/farm/farm.h"
#include "proto/clock.h"

namespace tessera {
namespace {

constexpr int kMaxChecks = 4096;  // asked for at once

std::string words_for(const RenderTask& task) {
  const Region& r = task.region;
  return fmt::format("samples {} to {} of pixels {} {} to {} {}", task.samples.begin, task.samples.end, r.x0,
                     r.y0, r.x1, r.y1);
}

}  // namespace

// Filter tasks cannot be done again, as the film they took is not kept: what comes of a filter follows from
// what was rendered.
void Farm::verify(const JobName& name, int tasks, std::uint64_t seed) {
  if (tasks < 1 || tasks > kMaxChecks)
    throw Error(ExitCode::bad_usage,
                fmt::format("{} tasks cannot be done again; accepted: 1 to {}", tasks, kMaxChecks));
  const JobRecord job = record(name);
  const Submission submission = submission_of(job);
  if (!submission.given.empty())
    throw Error(ExitCode::bad_usage,
                "job " + name +
                    " filters what it was given, and only what is rendered is done again:"
                    " its frames can be handed in again, and compared");
  const std::uint64_t count = store_.accepted_count(job.number);
  if (count == 0)
    throw Error(ExitCode::bad_usage, "no task of job " + name + " is on record yet; try again later");
  const std::vector<Job> frames = jobs_of(submission);
  std::mt19937_64 random(seed);
  int asked = 0;
  for (int tries = 0; asked < tasks && tries < 16 * tasks; ++tries) {
    const auto task =
        store_.accepted_at(job.number, std::uniform_int_distribution<std::uint64_t>(0, count - 1)(random));
    if (!task || !std::holds_alternative<RenderTask>(task->accepted.work)) continue;
    check(job, frames.at(task->place), *task);
    ++asked;
  }
  store_.add_event(job.number, unix_ms(), fmt::format("verify: {} tasks are done again", asked));
}

void Farm::check(const JobRecord& job, const Job& frame, const AcceptedRecord& task) {
  const Accepted& first = task.accepted;
  const RenderTask work = std::get<RenderTask>(first.work);
  const auto told = [this, name = job.job, number = job.number, first, work,
                     frame = frame.frame](const CheckResult& again) {
    const std::string what = fmt::format("verify: frame {}, {}", frame, words_for(work));
    std::string text;
    if (again.failure)
      text = fmt::format("{}: not done again: {}", what, *again.failure);
    else if (again.digest == first.digest)
      text = fmt::format("{}: the same bits from {} as from {}", what, again.name, first.worker);
    else
      text = fmt::format("{}: OTHER BITS from {} than from {}", what, again.name, first.worker);
    if (!again.failure && again.digest != first.digest) ++wrong_bits_;
    if (const auto there = store_.job(name); there && there->number == number) note(number, text);
  };
  coordinator_.check({frame, work, first.worker, first.device_class, told});
}

}  // namespace tessera
