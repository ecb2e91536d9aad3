// SPDX-License-Identifier: Apache-2.0
// BMFR (Koskela et al. 2019) of a whole picture, block by block, with what was kept of the frame before.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` and `history` as for tessera::filter; they are of whole pictures. RGB and what is kept, without
// TAA.
Image bmfr(const FilterPlan&, const Image& input, const Image& history);

}  // namespace tessera::reference
