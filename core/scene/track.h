// SPDX-License-Identifier: Apache-2.0
// Tracks (scene.h): the pose between two, and making them from a movement that is known at every time.
#pragma once

#include <Imath/ImathMatrix.h>

#include <functional>
#include <set>

#include "core/scene/scene.h"

namespace tessera {

// From a at s = 0 to b at s = 1: scale, rotation (the shortest way) and translation each on its own, as
// between two poses of a Track. Shear is lost.
Imath::M44d between(const Imath::M44d& a, const Imath::M44d& b, double s);

struct Sampling {
  double tolerance = 1e-3;  // by which interpolated poses may be off, as a share of the whole movement
  int halvings = 8;         // of the time between two of the times given, at most
};

// A track with poses at least at `times` (not empty), and between them where interpolation would be off.
Track sampled_track(const std::set<float>& times, const std::function<Imath::M44d(double seconds)>& pose,
                    const Sampling& sampling);

}  // namespace tessera
