// SPDX-License-Identifier: Apache-2.0
#include "coordinator/frame.h"

#include <utility>

#include "coordinator/given_frame.h"
#include "coordinator/rendered_frame.h"
#include "core/filter/history.h"

namespace tessera {

std::vector<Work> Frame::ready(std::vector<Work> tasks) {
  if (!awaits_history_) return tasks;
  waiting_.insert(waiting_.end(), tasks.begin(), tasks.end());
  return {};
}

std::vector<Work> Frame::remember(std::shared_ptr<const Image> history) {
  awaits_history_ = false;
  history_ = std::move(history);
  return std::exchange(waiting_, {});
}

FilterInput Frame::filter_input(const FilterTask& task) const {
  const Region& outer = task.tile.outer;
  FilterInput input{taken(outer), {}};
  if (history_) input.history = touched(*history_, motion(input.film), outer, job_.region());
  return input;
}

bool Frame::fits(const FilterTask& task, const Filtered& filtered) const {
  return filtered.region() == task.tile.inner && filtered.planes() == filter_shape(job_).answer;
}

std::unique_ptr<Frame> make_frame(const Job& job, Planes planes) {
  if (job.given) return std::make_unique<GivenFrame>(job, std::move(planes), true);
  return std::make_unique<RenderedFrame>(job, true);
}

std::unique_ptr<Frame> make_frame(const Job& job, FrameSnapshot snapshot, Planes planes) {
  if (job.given) return std::make_unique<GivenFrame>(job, std::move(planes), snapshot);
  return std::make_unique<RenderedFrame>(job, std::move(snapshot));
}

double frame_bytes(const Job& job) { return job.given ? GivenFrame::bytes(job) : RenderedFrame::bytes(job); }

}  // namespace tessera
