// SPDX-License-Identifier: Apache-2.0
// Where a thing on a Track stands at a time. No scene, no shutter.
#pragma once

#include <Imath/ImathQuat.h>

#include "core/scene/scene.h"

namespace tessera {

// The pose at a time in seconds: constant before the first key and after the last, exactly the key's matrix
// at a key. Between two keys a matrix is split into a stretch, a rotation and a translation by the polar
// decomposition (Shoemake and Duff 1992, "Matrix Animation and Polar Decomposition"); the stretch (scale
// along any axes, so shear is kept) and the translation are interpolated linearly, the rotation along the
// shorter great arc. A key without a rotation of its own (scaled to a line or a point) takes its neighbour's.
Matrix pose(const Track& track, double seconds);

// A track made ready to be asked often: the same poses, the decompositions done once.
class Movement {
 public:
  explicit Movement(Track track);  // at least one key, rising times

  Matrix at(double seconds) const;

  // p' = p * stretch * rotation + translation.
  struct Parts {
    Imath::M33d stretch;
    Imath::Quatd rotation;
    Imath::V3d translation;
  };

 private:
  struct Segment {
    Parts from, to;
  };
  Track track_;
  std::vector<Segment> segments_;  // between a key and the next
};

}  // namespace tessera
