// SPDX-License-Identifier: Apache-2.0
// A movement while the shutter is open, as Embree takes it: poses at equal steps, linear between them.
#pragma once

#include <vector>

#include "core/scene/track.h"

namespace tessera::tracer {

// When light comes in, in seconds. A time within is given as its share, 0 to 1. Equal: nothing moves.
struct Shutter {
  double open = 0, close = 0;
};

// As few poses, one more than a power of two, as keep within a thousandth of the true ones (of the matrix,
// and of the way travelled), the first and the last moment included; one if the thing stands still. At most
// 129.
std::vector<Matrix> motion_steps(const Movement& movement, Shutter shutter);

}  // namespace tessera::tracer
