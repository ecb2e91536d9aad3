// SPDX-License-Identifier: Apache-2.0
// SVGF (Schied et al. 2017) of a whole picture, pixel by pixel.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// As reference::filtered().
Image svgf(const FilterPlan&, const Image& input, const Image& history);

}  // namespace tessera::reference
