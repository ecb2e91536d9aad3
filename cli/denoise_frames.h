// SPDX-License-Identifier: Apache-2.0
// Which frames of a sequence `tessera denoise` reads and writes.
#pragma once

#include <set>

#include "cli/denoise.h"
#include "core/filter/filter.h"

namespace tessera {

struct DenoiseFrames {
  std::set<int> wanted;               // to be written
  std::set<int> forwards, backwards;  // to be read for that, in either direction, with handles
};

// Throws Error(bad_usage) for options that do not go together.
void check_options(const DenoiseOptions&, const FilterPlan&);

// Frames that start anew. Throws Error(bad_usage).
std::set<int> cuts_of(const DenoiseOptions&);

// Of an input that is a pattern. Throws InputError if there are none, Error(bad_usage) for `frames`.
DenoiseFrames frames_of(const DenoiseOptions&);

}  // namespace tessera
