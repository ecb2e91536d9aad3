// SPDX-License-Identifier: Apache-2.0
// A frame under way, from its journal.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "coordinator/frame.h"
#include "coordinator/store/journal.h"

namespace tessera {

struct RecoveredFrame {
  Frame frame;
  std::vector<Work> work;  // to be given out now: none of it is in
  // As Checkpoint has it, up to now.
  double seconds = 0;
  std::uint64_t dropped = 0;
  std::set<std::string> device_classes;
  std::vector<float> errors;
  bool awaits_history = true;  // Frame::remember() was not called yet
};

// Loads what Remembered speaks of; not called for an empty digest.
using LoadHistory = std::function<std::shared_ptr<const Image>(const Digest&)>;

// The frame as it was when the last entry was written; one that was never begun is begun. Entries that do not
// fit the job are cut off, with all behind them. If the round was complete but for the look, the look is
// still to be taken: see Frame::round_complete(). Throws InputError if the checkpoint is not one of this
// job's: then drop the journal, and begin anew.
RecoveredFrame recover(const Job& job, Journal& journal, const LoadHistory& load);

}  // namespace tessera
