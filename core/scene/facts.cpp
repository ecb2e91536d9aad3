// SPDX-License-Identifier: Apache-2.0
#include "core/scene/facts.h"

#include "core/scene/framing.h"

namespace tessera {

SceneFacts facts_of(const Scene& scene) {
  const Imath::Box3f bounds = bounds_of(scene);
  return {.diameter = bounds.isEmpty() ? 0 : double(bounds.size().length())};
}

}  // namespace tessera
