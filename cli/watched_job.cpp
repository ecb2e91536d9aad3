// SPDX-License-Identifier: Apache-2.0
#include "cli/watched_job.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::size_t kEventsKept = 16;

bool has_ended(const FrameSummary& f) {
  return f.state == FrameState::completed || f.state == FrameState::limited || f.state == FrameState::failed;
}

}  // namespace

const WatchView& WatchedJob::look() {
  look_at_frames();
  hear_news();
  look_at_workers();
  return view_;
}

// Pages until one that begins with a frame that is not over: those under way are near.
void WatchedJob::look_at_frames() {
  for (;;) {
    JobDetail page = farm_.ask<JobDetail>(ShowJob{job_, first_, previews_});
    view_.job = std::move(page.summary);
    const auto open = std::ranges::find_if_not(page.frames, has_ended);
    for (auto f = page.frames.begin(); f != open; ++f) {
      limited_ = limited_ || f->state == FrameState::limited;
      if (!f->preview.empty()) ended_preview_ = f->preview;
    }
    const bool more = open == page.frames.end() && !page.frames.empty();
    first_ += static_cast<std::uint32_t>(open - page.frames.begin());
    page.frames.erase(page.frames.begin(), open);
    view_.frames = std::move(page.frames);
    if (!more || first_ >= view_.job.frames) return;
  }
}

void WatchedJob::hear_news() {
  news_.clear();
  for (;;) {
    EventList page = farm_.ask<EventList>(ListEvents{job_, last_event_});
    if (page.events.empty()) break;
    last_event_ = page.events.back().number;
    news_.insert(news_.end(), page.events.begin(), page.events.end());
  }
  std::vector<JobEvent>& kept = view_.events;
  kept.insert(kept.end(), news_.begin(), news_.end());
  if (kept.size() > kEventsKept) kept.erase(kept.begin(), kept.end() - kEventsKept);
}

void WatchedJob::look_at_workers() {
  view_.workers.clear();
  for (;;) {
    const std::string after = view_.workers.empty() ? "" : view_.workers.back().id;
    WorkerList page = farm_.ask<WorkerList>(ListWorkers{after});
    if (page.workers.empty()) return;
    view_.workers.insert(view_.workers.end(), page.workers.begin(), page.workers.end());
  }
}

Progress WatchedJob::progress() const {
  const JobSummary& j = view_.job;
  Progress p{.samples_done = static_cast<std::int64_t>(j.pixel_samples),
             .seconds = j.seconds,
             .fraction = j.fraction,
             .seconds_left = j.seconds_left,
             .frames_done = static_cast<int>(j.frames_done),
             .frames = static_cast<int>(j.frames)};
  const auto active = std::ranges::find(view_.frames, FrameState::active, &FrameSummary::state);
  if (active == view_.frames.end()) return p;
  p.round = active->round;
  p.tiles_done = active->tiles_done;
  p.tiles_round = active->tiles;
  p.error = active->error;
  p.target = active->target;
  p.acceptable_share = active->acceptable_share;
  return p;
}

void WatchedJob::bring_preview(const std::filesystem::path& file) {
  const auto active =
      std::ranges::find_if(view_.frames, [](const FrameSummary& f) { return !f.preview.empty(); });
  const Digest wanted = active == view_.frames.end() ? ended_preview_ : active->preview;
  if (wanted.empty() || wanted == preview_) return;
  try {
    farm_.client().download(wanted, file);
    preview_ = wanted;
  } catch (const Error& e) {
    if (e.code() != ExitCode::bad_input) throw;  // there is a newer one already
  }
}

}  // namespace tessera
