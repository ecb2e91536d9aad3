// SPDX-License-Identifier: Apache-2.0
// The Feature Distance Filter (Lardinoije) of a whole picture, pixel by pixel.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image fdf(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
