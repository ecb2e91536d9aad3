// SPDX-License-Identifier: Apache-2.0
// SURE-based a-trous wavelets (Kim et al. 2016) of a whole picture, pixel by pixel.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image sure_atrous(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
