// SPDX-License-Identifier: Apache-2.0
// How far a frame, or a shot, is, as a value to show.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

namespace tessera {

struct Progress {
  int round = 0;                        // from 1
  std::int64_t samples_done = 0;        // pixel samples, over all rounds
  std::int64_t samples_round = 0;       // of them to be done by the end of this round
  int tiles_done = 0, tiles_round = 0;  // filtered in this round
  std::optional<double> error, target;  // relMSE of the frame at the last look; what is asked for
  double acceptable_share = 0;          // of the cells, at the last look
  double seconds = 0;                   // since the frame began
  double fraction = 0;                  // of the expected work, 0..1
  std::optional<double> seconds_left;   // expected
  int frames_done = 0, frames = 1;      // of a shot; the numbers above are of the frame that ends next, but
                                        // fraction and seconds_left, which are of the shot
};

using ProgressSink = std::function<void(const Progress&)>;

}  // namespace tessera
