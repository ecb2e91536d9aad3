// SPDX-License-Identifier: Apache-2.0
// Light from infinitely far away: constant, or an equirectangular picture that is sampled by its brightness.
#pragma once

#include <vector>

#include "worker/render/light/distribution.h"
#include "worker/render/vector_math.h"

namespace tessera::tracer {

class EnvironmentLight {
 public:
  explicit EnvironmentLight(const Scene& scene);  // borrowed; must outlive this

  bool black() const { return is_black(mean_); }
  // A picture is worth sampling; a constant is served best by the directions that surfaces choose.
  bool sampled() const { return picture_ && !black(); }
  const Color& mean() const { return mean_; }

  Color radiance(const Vec3& direction) const;

  struct Direction {
    Vec3 direction;
    float pdf;  // per steradian; 0: no direction
  };
  Direction sample(const Vec2& u) const;  // precondition: sampled()
  float pdf(const Vec3& direction) const;

 private:
  Vec2 uv(const Vec3& direction) const;

  const Picture* picture_ = nullptr;
  Color factor_, mean_;
  float cos_ = 1, sin_ = 0;  // of the rotation
  Distribution rows_;
  std::vector<Distribution> columns_;  // one a row
};

}  // namespace tessera::tracer
