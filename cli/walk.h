// SPDX-License-Identifier: Apache-2.0
// Frames filtered one after another, each by what was kept of the one before it: forwards in time, or from
// the last one to the first.
#pragma once

#include <optional>
#include <string>

#include "cli/noisy_files.h"
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
      : device_(device), options_(options), step_(step) {}

  // Goes by the frame `number - step` if that was the last one, and covered the same pixels.
  FilteredFrame next(const NoisyFrame&, int number);
  // The frame is missing from now on.
  void failed(int number) { last_ = Kept{number, {}, {}}; }

 private:
  struct Kept {
    int number = 0;
    Region display;
    Image planes;  // empty: the frame failed
  };
  std::string cut_before(const NoisyFrame&, int number) const;

  Device& device_;
  const DenoiseOptions& options_;
  int step_;
  std::optional<Kept> last_;
};

// The largest tile, whole or halved again and again, whose planes with halo fit into `bytes`, and those of
// its history and of what it keeps. Throws Error(out_of_memory) that says how much the least one takes.
Size tile_within(const FilterPlan&, const Region& frame, std::uint64_t bytes);

}  // namespace tessera
