// SPDX-License-Identifier: Apache-2.0
// How a frame becomes tasks. Pure: fixed by the job and the sample counts wanted, never by who works or how
// fast.
#pragma once

#include <vector>

#include "core/job.h"
#include "core/task.h"

namespace tessera {

// What the film of the job keeps: what was asked for, and what the filter and the stop rule need.
AovSet film_aovs(const Job&);
// What of it travels to be filtered.
AovSet filter_aovs(const Job&);

// Of the job's filter tasks: how many planes one takes of its frame and of the one before, and has as its
// answer, of which the last ones are kept for the frame behind.
struct FilterShape {
  int taken = 0, answer = 0, kept = 0;
};
FilterShape filter_shape(const Job&);

// The frame's tiles, with the halo of the job's filter.
std::vector<Tile> plan_tiles(const Job&);

// The cells of the job's region: the units of decision, in row-major order.
std::vector<Region> plan_cells(const Job&);

// The render tasks that bring each cell i from `have[i]` to `want[i]` samples (have == want: none). Pieces
// are the intersections of cells and tiles, cut to dyadic sample ranges of at most job.task_samples pixel
// samples, or up to four times that if the round then still has 256 tasks.
std::vector<RenderTask> plan_render(const Job&, const std::vector<int>& have, const std::vector<int>& want);

}  // namespace tessera
