// SPDX-License-Identifier: Apache-2.0
// Temporal anti-aliasing as a filter's last step, where `taa=on`: the picture is mixed with that of the frame
// before, as far as that lies within what the neighbouring pixels are now. It is biased: what neighbours do
// not show, a firefly or a highlight of one pixel, is cut to what they do.
#pragma once

#include <vector>

#include "core/filter/filter.h"

namespace tessera {

// Planes of history, the last ones that the filter keeps: the picture as it came out.
inline constexpr int kTaaPlanes = 3;

void append_taa_parameters(std::vector<Parameter>&);
bool with_taa(const ParameterValues&);
// Aov::motion, unless it is there already.
void append_taa_inputs(std::vector<Channel>&, const ParameterValues&);
// Its pass behind all others, if it is taken.
void append_taa_pass(std::vector<Pass>&, const ParameterValues&);
// Planes of history; floats of scratch a pixel.
int taa_history(const ParameterValues&);
double taa_scratch(const ParameterValues&);

}  // namespace tessera
