// SPDX-License-Identifier: Apache-2.0
// The scalar versions of all filters, by name.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` as for tessera::filter; it is the whole picture, and the whole frame. RGB.
Image filtered(const FilterPlan&, const Image& input);

}  // namespace tessera::reference
