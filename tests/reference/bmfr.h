// SPDX-License-Identifier: Apache-2.0
// BMFR (Koskela et al. 2019) of a single whole picture, block by block.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image bmfr(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
