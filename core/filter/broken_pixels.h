// SPDX-License-Identifier: Apache-2.0
// Pixels of a filter's input that are not finite: how many, where, and what becomes of them.
#pragma once

#include <string>
#include <vector>

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera {

// Of each plane that has any: "noisy.G: 2 pixels are not finite, the first at (3, 4)".
std::vector<std::string> broken_planes(const FilterPlan&, const Image& input);

// Light of which one channel is not finite is none at all: the pixel comes out black, not in the colour that is left.
void break_whole_colors(const FilterPlan&, Image& input);

}  // namespace tessera
