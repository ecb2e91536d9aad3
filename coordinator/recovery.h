// SPDX-License-Identifier: Apache-2.0
// A frame under way, from its journal.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "coordinator/frame.h"
#include "coordinator/store/journal.h"

namespace tessera {

struct RecoveredFrame {
  std::unique_ptr<Frame> frame;
  // What Checkpoint says beside the frame, up to the last entry.
  double seconds = 0;  // of the last look; 0: there was none
  std::uint64_t dropped = 0;
  std::set<std::string> device_classes;
  std::vector<float> errors;
  bool awaits_history = true;  // Frame::remember() is still to be called, and written down
};

// Loads what Remembered speaks of; not called for an empty digest.
using LoadHistory = std::function<std::shared_ptr<const Image>(const Digest&)>;

// The frame as it was when the last entry was written; one that was never begun is begun.
// Frame::outstanding() says what to do next, unless the round is complete but for the look, which is then
// still to be taken. `planes`: of a frame that is given. Entries that do not fit the frame are cut off, and
// all behind them. Throws Error if what is there cannot be used (damaged, of another job, or the history
// cannot be loaded): then drop the journal and begin anew.
RecoveredFrame recover(const Job& job, Journal& journal, const LoadHistory& load,
                       const Planes& planes = nullptr);

}  // namespace tessera
