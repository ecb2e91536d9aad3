// SPDX-License-Identifier: Apache-2.0
// A frame at the begin of a round, as a value: what has to be kept so that the frame can be gone on with, bit
// for bit. What follows from it (what was delivered at the last look, how many samples there are) is not in
// it.
#pragma once

#include <vector>

#include "core/acceptance.h"
#include "core/image.h"

namespace tessera {

struct FrameSnapshot {
  int round = 1;                // that begins, from 1; round - 1 looks were taken
  std::vector<int> have, want;  // samples of each cell before and after this round
  // Of the last look; all of these are empty in round 1.
  std::vector<CellLook> looks;    // of each cell
  std::vector<CellState> states;  // of each cell
  ErrorEstimate error;            // of the frame
  double acceptable_share = 0;
  Image sums;      // of the film
  Image stitched;  // filtered_planes() over the frame
};

}  // namespace tessera
