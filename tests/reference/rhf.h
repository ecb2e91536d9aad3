// SPDX-License-Identifier: Apache-2.0
// Scalar version of the filter `rhf`.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

Image rhf(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
