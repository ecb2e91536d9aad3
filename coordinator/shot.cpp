// SPDX-License-Identifier: Apache-2.0
#include "coordinator/shot.h"

#include "core/error.h"

namespace tessera {

bool continues(const Job& before, const Job& next) {
  const bool in_turn = next.given ? next.given->goes_on : next.frame == before.frame + 1;
  return in_turn && !next.cut && next.given.has_value() == before.given.has_value() && next.filter.history() > 0 &&
         next.crop == before.crop && next.render.size == before.render.size &&
         next.render.camera == before.render.camera && next.scene == before.scene &&
         next.filter.name == before.filter.name && next.filter.history() == before.filter.history();
}

void validate(const Shot& shot) {
  if (shot.frames.empty()) throw InputError("shot", "there is no frame", "one frame or more");
  for (const Job& job : shot.frames) validate(job);
}

ShotPlan::ShotPlan(Shot shot) : shot_(std::move(shot)) {}

std::optional<ShotPlan::Start> ShotPlan::start() {
  if (next_ == frames().size() || under_way_ >= shot_.in_flight) return std::nullopt;
  Start start{.frame = next_++, .awaits_history = false, .history = nullptr};
  ++under_way_;
  if (const auto given = shot_.histories.find(start.frame); given != shot_.histories.end()) {
    start.history = given->second;
  } else if (start.frame > 0 && continues_at(start.frame)) {
    const auto kept = kept_.extract(start.frame - 1);
    start.awaits_history = kept.empty();
    if (kept) start.history = kept.mapped();
  }
  return start;
}

std::optional<std::size_t> ShotPlan::end(std::size_t frame, std::shared_ptr<const Image> kept) {
  --under_way_, ++done_;
  const std::size_t next = frame + 1;
  if (next == frames().size() || !continues_at(next)) return std::nullopt;
  if (next < next_) return next;
  kept_[frame] = std::move(kept);
  return std::nullopt;
}

}  // namespace tessera
