// SPDX-License-Identifier: Apache-2.0
#include "core/filter/history.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// The taps around `at`, along an axis whose pixels are [begin, end).
struct Taps {
  int begin, end;
};
Taps taps_around(float at, int begin, int end) {
  if (!(at > static_cast<float>(begin) - 3 && at < static_cast<float>(end) + 3)) return {0, 0};
  const int floor = static_cast<int>(std::floor(at));
  return {std::max(floor - kTapsBefore, begin), std::min(floor + kTapsBehind + 1, end)};
}

}  // namespace

Region footprint(const Image& motion, const Region& area, const Region& frame) {
  Region box{frame.x1, frame.y1, frame.x0, frame.y0};
  for (int y = area.y0; y < area.y1; ++y)
    for (int x = area.x0; x < area.x1; ++x) {
      const Taps across = taps_around(static_cast<float>(x) - motion.at(0, x, y), frame.x0, frame.x1);
      const Taps down = taps_around(static_cast<float>(y) - motion.at(1, x, y), frame.y0, frame.y1);
      if (across.begin >= across.end || down.begin >= down.end) continue;
      box = {std::min(box.x0, across.begin), std::min(box.y0, down.begin), std::max(box.x1, across.end),
             std::max(box.y1, down.end)};
    }
  return box.empty() ? Region{} : box;
}

Image touched(const Image& history, const Image& motion, const Region& area, const Region& frame) {
  if (history.empty()) return {};
  const Region seen = footprint(motion, area, frame);
  return cropped(history, seen.empty() ? Region{frame.x0, frame.y0, frame.x0 + 1, frame.y0 + 1} : seen);
}

}  // namespace tessera
