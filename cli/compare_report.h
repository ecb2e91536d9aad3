// SPDX-License-Identifier: Apache-2.0
// What `tessera compare` found, as text for people, as JSON and as CSV. Each figure stands beside its domain.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "cli/compare_metrics.h"

namespace tessera {

enum class Format { text, json, csv };

struct WrittenMap {
  std::string metric;
  std::filesystem::path file;
  float high = 0;  // the error that is shown in yellow; black is 0
};

struct CellTable {
  std::string metric;
  Figure of;  // for its domain
  std::vector<CellErrors> cells;
};

struct FileFacts {
  std::map<std::string, std::variant<std::string, float, int>> origin;  // samples, seed, ...: as far as known
  std::int64_t not_finite = 0;                                          // pixels
  std::array<int, 2> first_not_finite{};                                // x, y of the first of them
};

struct FrameReport {
  int frame = 0;  // of a sequence
  Region region;
  Size tile;
  Display display;
  std::vector<Figure> figures;
  std::vector<CellTable> cells;
  std::vector<WrittenMap> maps;
  FileFacts image, reference;
};

struct SequenceReport {
  std::vector<FrameReport> frames;  // not empty
  std::vector<Figure> over_frames;  // figures that only all the frames have
};

// Of a figure that frames have: its mean over them, and the worst, where NaN is worse than any number.
struct Summary {
  Figure figure;  // of the first frame that has it; the remark only if all frames say the same
  double mean = 0, worst = 0;
  int worst_frame = 0;
};
std::vector<Summary> summaries(const SequenceReport&);

void write(std::ostream&, const FrameReport&, Format);
void write(std::ostream&, const SequenceReport&, Format);

}  // namespace tessera
