// SPDX-License-Identifier: Apache-2.0
// `tessera compare`: how far an image, or every frame of a sequence, is from a reference, in numbers and as
// maps.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "core/quality/display.h"
#include "core/quality/flip.h"

namespace CLI {
class App;
}

namespace tessera {

struct CompareOptions {
  std::filesystem::path image, reference;  // either may be a sequence, see compare_files.h
  std::string frames;                      // see parse_frames; empty: from the first to the last of the image
  std::string tile_size;                   // N or WxH; empty: the image's tessera/tile, else 256
  Display display;
  double pixels_per_degree = kPixelsPerDegree;
  std::vector<std::string> metrics;                                 // by name; empty: all
  std::vector<std::string> cells;                                   // metrics to tell of each cell
  std::vector<std::pair<std::string, std::filesystem::path>> maps;  // metric and PNG to write
  double map_scale = 0;  // the error that maps show in yellow; 0: 1 or a round number that fits
  std::filesystem::path
      sheet;  // PNG of noisy (if the image has that layer), image and reference; empty: none
  bool json = false, csv = false;
};

void describe(CLI::App&, CompareOptions&);

// Writes what it found to `out`. Returns 0; throws InputError for files that are missing, cannot be read or
// written, have no R, G, B, or do not cover the same pixels, and Error for options that are not accepted.
int compare(const CompareOptions&, std::ostream& out);

}  // namespace tessera
