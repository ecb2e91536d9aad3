// SPDX-License-Identifier: Apache-2.0
// The guided filter (Bauszat et al. 2011) of a whole picture, window by window.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture. RGB.
Image guided(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
