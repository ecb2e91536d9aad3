// SPDX-License-Identifier: Apache-2.0
// SBF (Li, Wu and Chuang 2012) of a whole picture, pixel by pixel.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image sbf(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
