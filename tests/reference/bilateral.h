// SPDX-License-Identifier: Apache-2.0
// Bilateral filters of a whole picture (van de Vlasakker 2013, equations 3.6 to 3.9).
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image bilateral(const FilterPlan&, const Image& input);
Image cross_bilateral(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
