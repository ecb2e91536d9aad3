// SPDX-License-Identifier: Apache-2.0
// RDFC (Rousselle, Manzi and Zwicker 2013) of a whole picture, offset by offset.
#pragma once

#include <vector>

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image rdfc(const FilterPlan&, const Image& input);

// One of the three filters, before any is chosen: what it makes of channel `c` of each pixel, and how that
// changes with the pixel's own value. By pixel, row after row.
struct RdfcCandidate {
  std::vector<double> value, derivative;
};
RdfcCandidate rdfc_candidate(const FilterPlan&, const Image& input, int candidate, int c);

}  // namespace tessera::reference
