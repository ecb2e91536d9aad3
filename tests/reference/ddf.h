// SPDX-License-Identifier: Apache-2.0
// The Data Driven Filter (van de Vlasakker 2013) of a whole picture, pixel by pixel.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image ddf(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
