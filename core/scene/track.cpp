// SPDX-License-Identifier: Apache-2.0
#include "core/scene/track.h"
namespace tessera {
Matrix pose(const Track& t, double) { return t.poses.front(); }
}  // namespace tessera
