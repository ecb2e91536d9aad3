// SPDX-License-Identifier: Apache-2.0
// What a temporal filter keeps of a frame for the next one: planes of its own over the frame, of which a tile
// takes along those pixels that its own were seen at one frame before. The image of all samples and those of
// the halves have histories of their own, for the halves are to stay independent.
#pragma once

#include "core/film.h"
#include "core/filter/filter.h"

namespace tessera {

// Of a frame: plan.history() planes for all samples, then as many for half A, then for half B.
inline int history_planes(const FilterPlan& plan) { return 3 * plan.history(); }

// A pixel seen at q = p - motion(p) one frame before takes from the pixels of [floor(q) - 1, floor(q) + 2]:
// the four around q, or, where they are of other surfaces, the nine around the nearest one (Schied et al.
// 2017, section 4.1).
inline constexpr int kTapsBefore = 1, kTapsBehind = 2;

// The box of all pixels of `frame` that the pixels of `area` may take from. `motion`: planes x and y over an
// image that contains `area`. Empty if they all come from outside. Motion that is not finite leads nowhere.
Region footprint(const Image& motion, const Region& area, const Region& frame);

// What of a frame's `history`, if there is one, travels with the pixels of `area`: their footprint, but at least a
// pixel. No history at all tells a filter that this is the first frame, which some treat otherwise (without_history).
Image touched(const Image& history, const Image& motion, const Region& area, const Region& frame);

}  // namespace tessera
