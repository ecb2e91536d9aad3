// SPDX-License-Identifier: Apache-2.0
// Scalar version of the filter `statmc`.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

Image statmc(const FilterPlan&, const Image& input);

// t such that Student's t with this many degrees of freedom exceeds it in magnitude with probability `level`.
double student_quantile(double level, double degrees);

}  // namespace tessera::reference
