// SPDX-License-Identifier: Apache-2.0
// Temporal anti-aliasing (Karis 2014) of a filter's picture.
#pragma once

#include "tests/reference/features.h"

namespace tessera::reference {

// `result`: what the filter yields, RGB first. `history`: the filter's, of which the last three planes are
// the old picture; empty: there is none. Mixes it into the RGB, and keeps that in the last three planes of
// `result`.
void taa(const FilterPlan&, const Image& input, const Image& history, Image& result);

}  // namespace tessera::reference
