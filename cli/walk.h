// SPDX-License-Identifier: Apache-2.0
// Frames filtered one after another, each by what was kept of the one before it: forwards in time, or from
// the last one to the first.
#pragma once

#include <string>

#include "cli/denoise_frames.h"
#include "cli/noisy_files.h"
#include "cli/succession.h"
#include "core/job.h"
#include "worker/denoise/runner.h"

namespace tessera {

struct FilteredFrame {
  Image image;      // RGB, then the planes that the filter keeps
  Size tile;        // in which it was filtered
  std::string cut;  // why there was no history to go by; empty: there was, or the walk begins here
};

class Walk {
 public:
  // `step`: 1 or -1. Borrows the device and the options.
  Walk(Device& device, const DenoiseOptions& options, int step)
      : device_(device), options_(options), succession_(step, cuts_of(options)) {}

  // Goes by what the last one has kept where it continues it (succession.h).
  FilteredFrame next(const NoisyFrame&, int number);
  // The frame is missing from now on.
  void failed(int number);

 private:
  Device& device_;
  const DenoiseOptions& options_;
  Succession succession_;
  Image kept_;  // of the last one; empty: nothing, or it failed
};

// The largest tile, the frame or `most`, or that halved again and again, whose planes with halo fit into
// `bytes`, and those of its history and of what it keeps. Throws Error(out_of_memory) that says how much the
// least one takes.
Size tile_within(const FilterPlan&, const Region& frame, std::uint64_t bytes,
                 Size most = {kMaxEdge, kMaxEdge});

}  // namespace tessera
