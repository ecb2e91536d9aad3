// SPDX-License-Identifier: Apache-2.0
// Pictures of frames under way, for those who look.
#include <algorithm>

#include "coordinator/farm/farm.h"
#include "proto/clock.h"

namespace tessera {

void Farm::draw_previews(Instant now) {
  for (Drawn& drawn : clerk_.drawn()) {
    previews_.made({drawn.job, drawn.place}, std::move(drawn.png));
    if (const auto job = open_.find(drawn.job); job != open_.end()) changed(job->second);
  }
  for (const Previews::Key& which : previews_.due(now)) draw_preview(which, now);
}

void Farm::draw_preview(const Previews::Key& which, Instant now) {
  const auto& [name, place] = which;
  const auto found = open_.find(name);
  if (found == open_.end() || !found->second.shot) return;
  const OpenJob& job = found->second;
  const auto i = static_cast<std::size_t>(std::ranges::find(job.places, place) - job.places.begin());
  const auto frames = coordinator_.frames(*job.shot);  // none, if it is over
  const auto frame = frames.find(i);
  if (frame == frames.end()) return;
  const Progress p = frame->second.state->frame->progress(0);
  const bool begun = p.samples_done > 0 || p.tiles_done > 0;
  if (!begun || !previews_.begin(which, {p.samples_done, p.round, p.tiles_done}, now)) return;
  const Instant began = clock_now();
  clerk_.draw({name, place, frame->second.state->frame->preview(), job.submission.exposure});
  previews_.took(which, std::chrono::duration_cast<Millis>(clock_now() - began));
}

}  // namespace tessera
