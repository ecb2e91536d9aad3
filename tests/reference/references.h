// SPDX-License-Identifier: Apache-2.0
// The scalar versions of all filters, by name.
#pragma once

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

// `input` and `history` as for tessera::filter; both are the whole picture, and the whole frame. RGB and the
// plan.history() planes that are kept.
Image filtered(const FilterPlan&, const Image& input, const Image& history = {});

}  // namespace tessera::reference
