// SPDX-License-Identifier: Apache-2.0
// Tracks (scene.h) of a movement that is known at every time.
#pragma once

#include <Imath/ImathMatrix.h>

#include <functional>
#include <set>

#include "core/scene/scene.h"

namespace tessera {

struct Sampling {
  double tolerance = 1e-3;  // by which interpolated poses may be off, as a share of the whole movement
  int halvings = 8;         // of the time between two of the times given, at most
};

// A track with poses at least at `times` (not empty), and between them where interpolation would be off.
Track sampled_track(const std::set<float>& times, const std::function<Imath::M44d(double seconds)>& pose,
                    const Sampling& sampling);

}  // namespace tessera
