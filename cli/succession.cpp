// SPDX-License-Identifier: Apache-2.0
#include "cli/succession.h"

#include <fmt/format.h>

namespace tessera {

std::string Succession::cut_before(const Frame& frame) const {
  if (!last_) return "";
  const int before = frame.number - step_;
  if (last_->number != before) return fmt::format("frame {} was not filtered", before);
  if (last_->pixels.empty()) return fmt::format("frame {} failed", before);
  if (cuts_.contains(step_ > 0 ? frame.number : before))
    return fmt::format("there is a cut before frame {}", step_ > 0 ? frame.number : before);
  if (last_->pixels != frame.pixels || last_->display != frame.display)
    return fmt::format("frame {} covers other pixels", before);
  return "";
}

Succession::Link Succession::next(int number, const Region& pixels, const Region& display) {
  const Frame frame{number, pixels, display};
  const std::string cut = cut_before(frame);
  const bool goes_on = last_ && cut.empty();
  last_ = frame;
  return {goes_on, cut};
}

}  // namespace tessera
