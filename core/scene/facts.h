// SPDX-License-Identifier: Apache-2.0
// What filters want to know of a whole scene, computed once per frame.
#pragma once

#include "core/filter/filter.h"
#include "core/scene/scene.h"

namespace tessera {

SceneFacts facts_of(const Scene& scene);

}  // namespace tessera
