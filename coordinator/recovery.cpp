// SPDX-License-Identifier: Apache-2.0
#include "coordinator/recovery.h"

#include <utility>

namespace tessera {
namespace {

// Does again what the entries say was done. False: an entry cannot be of this frame.
class Replay {
 public:
  Replay(RecoveredFrame& to, const LoadHistory& load) : to_(to), load_(load) {
    expect(to_.frame->outstanding());
  }

  bool operator()(LoggedEvent logged) {
    return std::visit([&](const auto& event) { return take(event, std::move(logged.pixels)); }, logged.event);
  }

 private:
  void expect(const std::vector<Work>& work) {
    for (const Work& w : work)
      if (const auto* render = std::get_if<RenderTask>(&w)) renders_.emplace(render->region, render->samples);
  }

  bool take(const Accepted& event, Image pixels) {
    const auto* render = std::get_if<RenderTask>(&event.work);
    const bool taken =
        render ? fold(*render, std::move(pixels)) : stitch(std::get<FilterTask>(event.work), pixels);
    if (!taken) return false;
    to_.dropped += event.dropped;
    to_.device_classes.insert(event.device_class);
    return true;
  }

  bool fold(const RenderTask& task, Image pixels) {
    Block block{task.samples, std::move(pixels)};
    if (renders_.erase({task.region, task.samples}) == 0 || !to_.frame->fits(task, block)) return false;
    to_.frame->fold(std::move(block));
    return true;
  }

  bool stitch(const FilterTask& task, const Image& pixels) {
    if (!to_.frame->fits(task, pixels)) return false;
    to_.frame->stitch(task, pixels);
    return true;
  }

  bool take(const Remembered& event, const Image&) {
    if (!std::exchange(to_.awaits_history, false)) return false;
    to_.frame->remember(event.history.empty() ? nullptr : load_(event.history));
    return true;
  }

  bool take(const Looked& event, const Image&) {
    if (!to_.frame->round_complete()) return false;
    expect(to_.frame->look({event.seconds}));
    to_.seconds = event.seconds;
    to_.errors.push_back(static_cast<float>(*to_.frame->progress(event.seconds).error));
    return true;
  }

  RecoveredFrame& to_;
  const LoadHistory& load_;
  std::set<std::pair<Region, SampleRange>> renders_;  // of this round, not folded yet
};

RecoveredFrame before_entries(const Job& job, const Journal& journal, const Planes& planes) {
  std::optional<Checkpoint> checkpoint = journal.checkpoint();
  if (!checkpoint) {
    RecoveredFrame begun{.frame = make_frame(job, planes), .device_classes = {}, .errors = {}};
    begun.frame->begin();
    return begun;
  }
  return {.frame = make_frame(job, std::move(checkpoint->frame), planes),
          .seconds = checkpoint->seconds,
          .dropped = checkpoint->dropped,
          .device_classes = std::move(checkpoint->device_classes),
          .errors = std::move(checkpoint->errors)};
}

}  // namespace

RecoveredFrame recover(const Job& job, Journal& journal, const LoadHistory& load, const Planes& planes) {
  RecoveredFrame frame = before_entries(job, journal, planes);
  journal.replay(
      [replay = Replay(frame, load)](LoggedEvent logged) mutable { return replay(std::move(logged)); });
  return frame;
}

}  // namespace tessera
