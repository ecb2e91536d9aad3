// SPDX-License-Identifier: Apache-2.0
// Where things on a track are.
#pragma once

#include "core/scene/scene.h"

namespace tessera {

Matrix pose(const Track&, double seconds);

}  // namespace tessera
