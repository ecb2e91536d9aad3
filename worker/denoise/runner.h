// SPDX-License-Identifier: Apache-2.0
// Runs a filter's passes over one tile: outer region in, inner region out.
#pragma once

#include "core/film.h"
#include "core/filter/filter.h"
#include "core/task.h"
#include "worker/denoise/device.h"

namespace tessera {

// `input`: the planes of plan.inputs(), in that order, over tile.outer. `frame` is the whole
// frame (or crop): what lies outside it is skipped by every tap. Returns RGB over tile.inner.
Image filter(Device&, const FilterPlan&, const Image& input, const Tile& tile, const Region& frame);

// A whole filter task: develops the film sums over tile.outer for all samples, half A and half B and filters
// each.
Filtered filter_task(Device&, const FilterPlan&, const Image& sums, const FilmLayout&, const Tile&,
                     const Region& frame);

}  // namespace tessera
