// SPDX-License-Identifier: Apache-2.0
#include "coordinator/farm/previews.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr Millis kInterest{10'000}, kInterval{2000};
constexpr int kShare = 100;  // of the time at the most, in which one is prepared

}  // namespace

std::vector<Previews::Key> Previews::due(Instant now) const {
  std::vector<Key> frames;
  for (const auto& [frame, shown] : shown_)
    if (!shown.under_way && now - shown.asked <= kInterest && now >= shown.next) frames.push_back(frame);
  return frames;
}

bool Previews::begin(const Key& frame, const State& state, Instant now) {
  Shown& shown = shown_.at(frame);
  if (shown.state == state) return false;
  shown.state = state;
  shown.under_way = true;
  shown.next = now + kInterval;
  return true;
}

void Previews::took(const Key& frame, Millis duration) {
  Shown& shown = shown_.at(frame);
  shown.next += std::max(Millis(0), kShare * duration - kInterval);
}

void Previews::made(const Key& frame, std::string png) {
  const auto found = shown_.find(frame);
  if (found == shown_.end()) return;  // the frame has ended
  Shown& shown = found->second;
  shown.under_way = false;
  if (png.empty()) return;
  shown.before = std::move(shown.last);
  shown.last.digest = sha256(png);
  shown.last.png = std::make_shared<const std::string>(std::move(png));
}

void Previews::forget(const JobName& job) {
  std::erase_if(shown_, [&](const auto& shown) { return shown.first.first == job; });
}

Digest Previews::last(const Key& frame) const {
  const auto found = shown_.find(frame);
  return found == shown_.end() ? Digest{} : found->second.last.digest;
}

Previews::Png Previews::find(const Digest& digest) const {
  for (const auto& [frame, shown] : shown_)
    for (const Picture* picture : {&shown.last, &shown.before})
      if (picture->digest == digest) return picture->png;
  return nullptr;
}

}  // namespace tessera
