// SPDX-License-Identifier: Apache-2.0
// SVGF (Schied et al. 2017) of a single whole picture, pixel by pixel.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image svgf(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
