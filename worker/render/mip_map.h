// SPDX-License-Identifier: Apache-2.0
// Ever smaller versions of a picture.
#pragma once

#include "core/scene/scene.h"

namespace tessera::tracer {

// Half as wide and as high, rounded down but at least 1: each texel is the mean of what it covers, so that
// the mean of the picture stays what it is. An odd edge is divided into parts of 2 + 1/n texels: the
// polyphase box filter of Guthe and Heckbert 2005, "Non-Power-of-Two Mipmapping".
Picture half_size(const Picture&);

// How many pictures there are, down to one texel.
int mip_levels(const Picture&);

}  // namespace tessera::tracer
