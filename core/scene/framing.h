// SPDX-License-Identifier: Apache-2.0
// How far a scene reaches, and a camera for a scene that has none.
#pragma once

#include <Imath/ImathBox.h>

#include "core/scene/scene.h"

namespace tessera {

// World space; of what is on a track, where it is without it. Empty if there is nothing.
Imath::Box3f bounds_of(const Scene& scene);

// Looks at the middle of what there is, from the front, a little from the right and above, so that all of it
// is seen in a square or wider picture.
Camera framing_camera(const Scene& scene);

}  // namespace tessera
