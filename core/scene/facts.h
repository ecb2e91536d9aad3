// SPDX-License-Identifier: Apache-2.0
// What filters want to know of a whole scene, computed once per frame.
#pragma once

#include "core/filter/filter.h"
#include "core/scene/scene.h"

namespace tessera {

// `light` is the mean of the luminances of what emits, every emitter once: each material in use by the
// radiance of its surface, the environment by its radiance (pictures and textures count as white), and what
// has no radiance, a sun or a lamp without size, by that of white paper it lights, from half the scene's
// diameter away. 0: nothing emits.
SceneFacts facts_of(const Scene& scene);

}  // namespace tessera
