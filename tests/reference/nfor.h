// SPDX-License-Identifier: Apache-2.0
// NFOR (Bitterli et al. 2016) of a whole picture: each window spreads what it predicts.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image nfor(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
