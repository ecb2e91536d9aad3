// SPDX-License-Identifier: Apache-2.0
// Made-up inputs for filters: two surfaces with an edge between them, textured, noisy, under a sky.
#pragma once

#include <string_view>

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera {

// noise: everything random   constant: the same light on flat, bare surfaces   sky: noise with a disc and
// single pixels of sky   converged: noise of variance 0   firefly: noise with a few pixels 1e6 times brighter
// extreme: light from 1e-30 to 1e30   denormal: half of light and variances, a quarter of features, is 0, or
// that small or its square is
inline constexpr std::string_view kKinds[] = {"noise",   "constant", "sky",     "converged",
                                              "firefly", "extreme",  "denormal"};
// Light from 1e-12 to 1e12, whose squares fit into a float.
inline constexpr std::string_view kWide = "wide";

// The planes of plan.inputs() over `region`. A pixel's values depend on its coordinates and `seed` only.
// Seeds one after the other make frames of a shot: surfaces that pan, rest, leave and come, in which part of
// every frame is found in the one before.
Image made_up_input(const FilterPlan& plan, const Region& region, std::string_view kind, unsigned seed = 1);

// The AOV in which the filter takes light: color, or indirect where it takes direct and indirect light apart.
Aov light_of(const FilterPlan& plan);

// The plane of a channel in the filter's input, of half A where it takes halves.
int plane_of(const FilterPlan& plan, Aov aov, int index, Statistic statistic = Statistic::mean);

// Makes (x, y) sky of the given radiance.
void put_sky(Image& input, const FilterPlan& plan, int x, int y, float radiance);

}  // namespace tessera
