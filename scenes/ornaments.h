// SPDX-License-Identifier: Apache-2.0
// What stands and hangs in the courtyard.
#pragma once

#include "scenes/shapes.h"

namespace tessera::scenes {

inline constexpr float kSpringing = 2.35f;  // metres, height of a column with its capital

Shape column();

inline constexpr float kGlobe = -0.7f, kGlobeRadius = 0.14f;  // of a lantern: height from where it hangs

// The brass of a lantern that hangs from the origin: a rod and a cap. What little of it is near the globe
// stays small, for brightly lit brass would be a lamp that no light sampling knows of.
Shape lantern();

// An agave.
Shape rosette();

}  // namespace tessera::scenes
