// SPDX-License-Identifier: Apache-2.0
// The descriptions that make up filters(): one function, one file, one filter each.
#pragma once

#include "core/filter/filter.h"

namespace tessera {

FilterDescription describe_none();
FilterDescription describe_atrous();
FilterDescription describe_svgf();

// Levels 0 .. levels-1 of the a-trous wavelet transform (Dammertz et al. 2010, section 2): the 5x5 B3 kernel
// with 2^i - 1 holes between its taps, so that level i reads 2 * 2^i pixels far. Appended to `passes`.
void append_levels(std::vector<Pass>& passes, std::string_view kernel, int levels);

// The parameter `levels` of both a-trous filters.
Parameter levels_parameter(std::string_view source);

}  // namespace tessera
