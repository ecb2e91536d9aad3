// SPDX-License-Identifier: Apache-2.0
// The two kinds of work a worker is given, and what it answers.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "core/film.h"
#include "core/filter/history.h"
#include "core/region.h"

namespace tessera {

using JobId = std::uint64_t;
using TaskId = std::uint64_t;  // unique in a coordinator's life

// Render `samples` of every pixel of `region`.
struct RenderTask {
  Region region;
  SampleRange samples;
  bool operator==(const RenderTask&) const = default;
};

// Filter `tile`; what the filter takes over tile.outer travels along, and of a temporal filter the history
// that it touches.
struct FilterTask {
  Tile tile;
  int round = 0;
  bool operator==(const FilterTask&) const = default;
};

using Work = std::variant<RenderTask, FilterTask>;

struct Task {
  TaskId id = 0;
  JobId job = 0;
  Work work;
  bool operator==(const Task&) const = default;
};

// What a filter task works on; both are empty for other tasks.
struct FilterInput {
  Image film;     // sums over tile.outer; of a frame that is given: the filter's planes
  Image history;  // what the frame before keeps, where tile.outer was seen; empty: there is none
};

// The answer to a filter task: planes over tile.inner.
//   0..2 the filter run on all samples   3..5 on half A   6..8 on half B
//   then what a temporal filter keeps for the next frame, in the same order: see filter/history.h
// Of a frame that is given there are no halves: 0..2, then what is kept. See FilterShape in core/plan.h.
inline constexpr int kFilteredPlanes = 9;
inline int filtered_planes(const FilterPlan& plan) { return kFilteredPlanes + history_planes(plan); }
using Filtered = Image;

}  // namespace tessera
