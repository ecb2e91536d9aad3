// SPDX-License-Identifier: Apache-2.0
#include "coordinator/farm/open_job.h"

#include <algorithm>

namespace tessera {
namespace {

std::size_t largest_frame(const Submission& s) {
  const auto area = [](const SubmittedFrame& frame) { return frame.region.area(); };
  const auto largest = std::ranges::max_element(s.given, {}, area);
  return largest == s.given.end() ? 0 : static_cast<std::size_t>(largest - s.given.begin());
}

}  // namespace

double bytes_of(const Submission& s) {
  const std::size_t frames = std::min<std::size_t>(s.frames.size(), Shot{}.in_flight);
  return frame_bytes(job_of(s, largest_frame(s))) * static_cast<double>(frames);
}

bool has_ended(const FrameRecord& f) {
  return f.state == FrameState::completed || f.state == FrameState::limited || f.state == FrameState::failed;
}

// A frame whose history is gone takes those along that lead up to it.
StillToDo still_to_do(const std::vector<Job>& jobs, const std::vector<FrameRecord>& frames) {
  std::vector<bool> wanted(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) wanted[i] = !has_ended(frames[i]);
  std::map<std::size_t, Digest> history_at;
  for (std::size_t i = jobs.size(); i-- > 1;) {
    if (!wanted[i] || wanted[i - 1] || !continues(jobs[i - 1], jobs[i])) continue;
    if (frames[i - 1].state == FrameState::failed || !frames[i - 1].kept.empty())
      history_at[i] = frames[i - 1].kept;
    else
      wanted[i - 1] = true;
  }
  StillToDo left;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (!wanted[i]) continue;
    if (const auto at = history_at.find(i); at != history_at.end())
      left.histories[left.places.size()] = at->second;
    left.places.push_back(i);
  }
  return left;
}

}  // namespace tessera
