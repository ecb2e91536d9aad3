// SPDX-License-Identifier: Apache-2.0
// Box and Gaussian of a whole picture, as two-dimensional windows.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image box(const FilterPlan&, const Image& input);
Image gaussian(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
