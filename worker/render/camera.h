// SPDX-License-Identifier: Apache-2.0
// From pixels to rays and back: thin lens, orthographic and equirectangular cameras that may move while the
// shutter is open.
#pragma once

#include <optional>
#include <vector>

#include "core/region.h"
#include "worker/render/wide.h"

namespace tessera::tracer {

struct Ray {
  Vec3 origin, direction;  // unit
};

struct WideRay {
  Wide3 origin, direction;
};

class CameraRays {
 public:
  // How the camera of `scene` sees between `open` and `close` (seconds). `focus`: distance along the view
  // axis, in place of the camera's own.
  CameraRays(const Scene& scene, const Camera& camera, const Size& frame, double open, double close);

  // (x, y) in pixels of the frame, y down; `lens` in [0, 1)^2; `time` in [0, 1]: from open to close.
  Ray ray(float x, float y, const Vec2& lens, float time) const;
  // The same for a packet where rays differ by their pixels alone.
  bool pinhole() const { return projection_ == Camera::Projection::perspective && !moves() && !has_lens(); }
  WideRay pinhole_rays(const Wide2& pixels) const;  // precondition: pinhole()
  // As without a lens: through the lens' centre.
  Ray central_ray(float x, float y, float time) const;
  Vec3 origin(float time) const { return (steps_.size() == 1 ? steps_[0] : axes(time)).origin; }
  bool parallel() const { return projection_ == Camera::Projection::orthographic; }
  bool moves() const { return steps_.size() > 1; }
  bool has_lens() const { return lens_radius_ > 0; }
  void focus_at(float distance) { focus_distance_ = distance; }

  // Distance along the view axis; from a panorama's place: as the crow flies.
  float depth(const Vec3& point, float time) const;
  // Where a point is seen, in pixels, if it is: not behind the camera. May be outside the frame. Of a
  // panorama: the copy nearest to `near`.
  std::optional<Vec2> pixel(const Vec3& point, float time, const Vec2& near) const;

  // How wide a pixel is, at distance d along a ray: footprint + spread * d.
  float footprint() const { return footprint_; }
  float spread() const { return spread_; }

 private:
  struct Axes {
    Vec3 origin, right, up, forward;  // axes are unit vectors in the world
  };
  Axes axes(float time) const;
  static Axes blended(const Axes& a, const Axes& b, float t);
  Vec2 on_lens(const Vec2& u) const;

  Camera::Projection projection_;
  std::vector<Axes> steps_;     // evenly spaced in time; one if the camera rests
  Vec2 frame_, scale_, shift_;  // pixel -> slope, or world units if orthographic: x * scale + shift
  float lens_radius_, focus_distance_;
  std::vector<Vec2> corners_;  // of the aperture's polygon in the unit circle; empty: round
  float footprint_ = 0, spread_ = 0;
};

}  // namespace tessera::tracer
