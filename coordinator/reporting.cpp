// SPDX-License-Identifier: Apache-2.0
// What a coordinator tells of its shots: how far they are, and what came of a frame.
#include <algorithm>
#include <utility>

#include "coordinator/coordinator.h"
#include "proto/clock.h"

namespace tessera {

Progress Coordinator::progress(ShotId shot) const { return progress(shot, runs_.at(shot), clock_now()); }

Progress Coordinator::progress(ShotId shot, const Run& run, Instant now) const {
  const int frames = static_cast<int>(run.plan.frames().size());
  Progress p{.fraction = 1};  // but for
  double whole = run.plan.done();
  bool first = true;
  for (const auto& [id, active] : active_) {
    if (active.shot != shot) continue;
    const Progress one = active.frame().progress(seconds_between(active.started, now));
    if (std::exchange(first, false)) p = one;
    whole += one.fraction;
  }
  if (frames == 1 && !first) return p;
  p.frames = frames;
  p.frames_done = run.plan.done();
  p.fraction = run.plan.over() ? 1 : std::min(0.999, whole / frames);
  p.seconds = seconds_between(run.begun, now);
  if (whole > 0) p.seconds_left = p.seconds * (frames - whole) / whole;
  return p;
}

std::map<std::size_t, Coordinator::FrameNow> Coordinator::frames(ShotId shot) const {
  const Instant now = clock_now();
  std::map<std::size_t, FrameNow> under_way;
  for (const auto& [id, active] : active_)
    if (active.shot == shot) under_way[active.place] = {&active.state, seconds_between(active.started, now)};
  return under_way;
}

JobReport Coordinator::report(Active&& a, Instant now) {
  JobReport report = Coordinator::report(a, FrameImage{}, now);
  report.image = std::move(a.frame()).image();
  return report;
}

JobReport Coordinator::report(const Active& a, Instant now) { return report(a, a.frame().image(), now); }

JobReport Coordinator::report(const Active& a, FrameImage image, Instant now) {
  const bool keeps = !a.failure && a.frame().stopped() && a.frame().job().filter.history() > 0;
  return {.image = std::move(image),
          .seconds = seconds_between(a.started, now),
          .dropped = a.state.dropped,
          .device_classes = a.state.device_classes,
          .errors = a.state.errors,
          .failure = a.failure,
          .bad_input = a.bad_input,
          .kept = keeps ? a.frame().kept() : nullptr,
          .continued = a.frame().continued()};
}

}  // namespace tessera
