// SPDX-License-Identifier: Apache-2.0
// A camera for a scene that has none.
#pragma once

#include "core/scene/scene.h"

namespace tessera {

// Looks at the middle of what there is, from the front, a little from the right and above, so that all of it
// is seen in a square or wider picture.
Camera framing_camera(const Scene& scene);

}  // namespace tessera
