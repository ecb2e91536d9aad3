// SPDX-License-Identifier: Apache-2.0
// What a filter takes of a frame, as a file: how frames that are there already come to a farm.
#pragma once

#include <string>

#include "core/exr.h"
#include "core/filter/filter.h"

namespace tessera {

// `input`: the planes of plan.inputs(), each under the name that core/layers.h gives it, to all of its bits.
ExrImage given_file(const FilterPlan&, Image input, const Region& display);

// The planes of plan.inputs(), in that order. `name`: of the file, for messages. Throws InputError unless it
// covers `region`, and holds these channels and no others.
Image given_planes(const FilterPlan&, const ExrImage& file, const Region& region, const std::string& name);

}  // namespace tessera
