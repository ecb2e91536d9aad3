// SPDX-License-Identifier: Apache-2.0
// What a sample tells besides its light: the channels that filters and compositors go by.
#pragma once

#include "core/job.h"
#include "worker/render/block_keys.h"
#include "worker/render/camera.h"
#include "worker/render/path.h"
#include "worker/render/render_scene.h"
#include "worker/render/sample_sums.h"

namespace tessera::tracer {

// The cameras a frame is seen through.
struct Views {
  CameraRays now;
  CameraRays before;  // one frame earlier
  CameraRays after;   // one frame later
};

class Guides {
 public:
  // All are borrowed and must outlive this.
  Guides(const RenderScene& scene, AovSet aovs, const Views& views);

  // Of the camera ray of path `lane`: what it hit (surface and scattering are there), or that it hit nothing.
  void first_hit(const Paths& paths, int lane, SampleBlock& out) const;
  void sky(const Paths& paths, int lane, SampleBlock& out) const;
  // Instead of what first_hit() said of a shadow catcher: it is the backdrop, covered by `shadow` (0..1).
  void caught(const Paths& paths, int lane, float shadow, SampleBlock& out) const;
  // The path left the first hit, along its direction.
  void first_bounce(const Paths& paths, int lane, SampleBlock& out) const;
  // The path hit something after scattering `bounce` + 1 times. Closes its search for texture2 if this is it.
  void later_hit(Paths& paths, int lane, int bounce, SampleBlock& out) const;
  // The sample as a whole; `screen` in pixels, `lens` as the camera got it.
  void sample(int lane, const Paths& paths, const Color& color, const Vec2& screen, const Vec2& lens,
              SampleBlock& out) const;

  bool takes_bounces(const SampleBlock& out) const { return vectors_ || out.has(Aov::bounce); }
  bool samples_points() const { return points_; }
  // The point-sampled channels of a block: by rays through the pixels' centres, without lens, at the middle
  // of the shutter. Uses `rays`.
  void point_samples(const BlockKeys& block, Packet& rays, SampleBlock& out) const;

 private:
  void point_sample(const Hit& hit, const Surface& s, const Ray& ray, const Vec2& pixel, int lane,
                    SampleBlock& out) const;
  // The way on the picture from where something is seen through `from` to where it is seen through `to`.
  static Vec2 way(const CameraRays& from, const Vec3& there, const CameraRays& to, const Vec3& here,
                  const Vec2& pixel);
  void sky_point(const Ray& ray, const Vec2& pixel, int lane, SampleBlock& out) const;
  Vec2 depth_gradient(const Surface& s, const Vec2& pixel) const;
  void vector_part(int at, int lane, const Vec3& v, SampleBlock& out) const;

  const RenderScene& scene_;
  const Views& views_;
  bool albedo_, vectors_, points_;
  std::vector<float> object_mattes_, material_mattes_;  // ids; 0: nameless. Empty if nobody asks
};

}  // namespace tessera::tracer
