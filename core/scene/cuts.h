// SPDX-License-Identifier: Apache-2.0
// Where a shot of one camera cuts: what was seen before is not to be found in the picture after it, not even on the
// same surfaces, for mirrors show something else.
#pragma once

#include <vector>

#include "core/scene/scene.h"

namespace tessera {

// Of these frames those before which the camera jumps: from one frame to it the camera moves at least five times as
// far, or turns five times as much, as in the frames beside, and by more than 2 % of the scene's diameter or 10
// degrees. Whatever the frames, a frame is one or is not. A whip pan within one single frame counts as a cut, which
// costs its history.
std::vector<int> cuts_of(const Scene&, const Camera&, const std::vector<int>& frames);

}  // namespace tessera
