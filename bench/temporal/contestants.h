// SPDX-License-Identifier: Apache-2.0
// Which filters are judged on scenes in motion, and in which comparison.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/filter/filter.h"

namespace tessera::temporal {

// filters: those of the papers, each alone and with its history. features: BMFR by more and more feature
// buffers; blocks: by the edge of its blocks.
inline constexpr std::string_view kGroups[] = {"filters", "features", "blocks"};

struct Contestant {
  std::string group, name;  // name: what the tables say, as it is asked for
  std::string filter;       // as parse_filter() reads it; "none": the noisy picture
  int samples = 1;          // of a pixel, a frame
  double x = 0;             // features: how many; blocks: pixels
};

// "FILTER" or "FILTER@SAMPLES": a peer that is given more than the others. Throws as parse_filter() does, and
// Error(bad_usage) for samples that are no power of two.
Contestant parse_contestant(const std::string& text, int samples);

std::vector<Contestant> standard_contestants(const std::string& group, int samples);

}  // namespace tessera::temporal
