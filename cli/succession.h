// SPDX-License-Identifier: Apache-2.0
// Which frames of a shot go by the one before, as they come one after another: forwards in time, or from the
// last one to the first.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "core/region.h"

namespace tessera {

class Succession {
 public:
  // `step`: 1 or -1. `cuts`: numbers of frames before which, in time, there is one.
  explicit Succession(int step, std::set<int> cuts = {}) : step_(step), cuts_(std::move(cuts)) {}

  struct Link {
    bool goes_on = false;  // by the frame before
    std::string cut;       // why not; empty: it does, or is the first
  };
  // Of the next frame: it goes by `number - step` if that was the last one, did not fail, and covered the
  // same pixels of the same picture, and there is no cut between them.
  Link next(int number, const Region& pixels, const Region& display);
  // The frame is missing.
  void failed(int number) { last_ = Frame{number, {}, {}}; }

 private:
  struct Frame {
    int number = 0;
    Region pixels, display;  // empty: it failed
  };
  std::string cut_before(const Frame& frame) const;

  int step_;
  std::set<int> cuts_;
  std::optional<Frame> last_;
};

}  // namespace tessera
