// SPDX-License-Identifier: Apache-2.0
// Runs a filter's passes over one tile: outer region in, inner region out.
#pragma once

#include "core/film.h"
#include "core/filter/filter.h"
#include "core/task.h"
#include "worker/denoise/device.h"

namespace tessera {

// `input`: the planes of plan.inputs(), in that order, over tile.outer. `frame` is the whole
// frame (or crop): what lies outside it is skipped by every tap. `history`: plan.history() planes of the
// frame before, over what footprint() says or more; empty: there is none, be it that this is the first frame
// or that the shot was cut. Returns RGB over tile.inner, then the plan.history() planes that it keeps.
Image filter(Device&, const FilterPlan&, const Image& input, const Tile& tile, const Region& frame,
             const Image& history = {});

// A result that is no longer needed: the device's next one is written to its memory.
void recycle(Device&, Image result);

// A whole filter task: develops the film sums over tile.outer for all samples, half A and half B and filters
// each with its history: history_planes(plan) planes, or empty.
Filtered filter_task(Device&, const FilterPlan&, const Image& sums, const FilmLayout&, const Tile&,
                     const Region& frame, const Image& history = {});

}  // namespace tessera
