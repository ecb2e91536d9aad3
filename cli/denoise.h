// SPDX-License-Identifier: Apache-2.0
// `tessera denoise`: runs a filter on files that some renderer has written, one image or a sequence of them.
#pragma once

#include <CLI/CLI.hpp>

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "core/filter/filter.h"
#include "core/region.h"

namespace tessera {

struct DenoiseOptions {
  std::string input, output;  // EXR files, or patterns of a sequence
  std::string frames;         // of a sequence; empty: all that are there
  std::string filter = "svgf";
  std::vector<std::string> guides;  // LAYER=FILE
  std::optional<double> samples;    // per pixel
  std::string tile_size;            // empty: as large as `memory` allows
  std::uint64_t memory = 1024;      // MiB that filtering a tile may take
  std::string device;
  std::string compression = "zip";
  double exposure = 0;  // of the preview
  bool quiet = false;
};

void describe(CLI::App&, DenoiseOptions&);

// Filters every frame; one that fails does not keep the others from being written. Returns the exit code.
int denoise(const DenoiseOptions&, std::ostream& out, std::ostream& problems);

// The largest tile, whole or halved again and again, whose planes with halo fit into `bytes`. Throws
// Error(out_of_memory) that says how much the least one takes.
Size tile_within(const FilterPlan&, const Region& frame, std::uint64_t bytes);

}  // namespace tessera
