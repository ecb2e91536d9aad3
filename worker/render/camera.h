// SPDX-License-Identifier: Apache-2.0
// Thin-lens perspective camera: two pairs of random numbers in, a ray out.
#pragma once

#include "core/region.h"
#include "worker/render/vector_math.h"

namespace tessera::tracer {

struct Ray {
  Vec3 origin, direction;  // unit
};

class CameraRays {
 public:
  CameraRays(const Camera& camera, const Size& frame);

  // (x, y) in pixels of the frame, y down; `lens` in [0, 1)^2.
  Ray ray(float x, float y, const Vec2& lens) const;
  bool has_lens() const { return lens_radius_ > 0; }
  const Vec3& forward() const { return forward_; }
  const Vec3& origin() const { return origin_; }

 private:
  Vec3 origin_, right_, up_, forward_;  // unit axes in the world
  Vec2 scale_, shift_;                  // pixel -> slope: x * scale + shift
  float lens_radius_, focus_distance_;
};

}  // namespace tessera::tracer
