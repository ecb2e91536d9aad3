// SPDX-License-Identifier: Apache-2.0
// `tessera denoise`: runs a filter on files that some renderer has written, one image or a sequence of them.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "cli/link_options.h"

namespace CLI {
class App;
}

namespace tessera {

struct DenoiseOptions {
  std::string input, output;          // EXR files, or patterns of a sequence
  std::optional<std::string> frames;  // of a sequence; none: all that are there
  std::string cuts;                   // frames that start anew
  int handles = 0;                    // frames around them that are read for the sake of history
  bool both_ways = false;             // by the frames that follow, too
  std::string filter = "svgf";
  std::vector<std::string> guides;  // LAYER=FILE
  std::string motion_scale;         // X,Y; empty: as the vectors' names say
  bool resting = false;             // nothing moves where there are no motion vectors
  std::optional<double> samples;    // per pixel
  std::string tile_size;            // empty: as large as `memory` allows
  std::uint64_t memory = 1024;      // MiB that filtering a tile may take
  std::string device;
  LinkOptions farm{.coordinator = "", .keys = {}};  // no coordinator: on this machine
  std::string compression = "zip";
  double exposure = 0;  // of the preview
  bool quiet = false;
};

void describe(CLI::App&, DenoiseOptions&);

// Filters every frame, in ascending order, on this machine or through a farm, to the same bits; one that
// fails does not keep the others from being written. Returns the exit code.
int denoise(const DenoiseOptions&, std::ostream& out, std::ostream& problems);

}  // namespace tessera
