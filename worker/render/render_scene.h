// SPDX-License-Identifier: Apache-2.0
// A scene and everything derived from it that tracing needs.
#pragma once

#include "worker/render/bvh.h"
#include "worker/render/light/lights.h"
#include "worker/render/material.h"
#include "worker/render/motion.h"
#include "worker/render/render.h"

namespace tessera {

namespace tracer {
// When the camera's shutter is open for a frame.
Shutter shutter_of(const Scene& scene, const Camera& camera, double frame);
}  // namespace tracer

class RenderScene {
 public:
  explicit RenderScene(std::shared_ptr<const Scene> scene, tracer::Shutter shutter = {},
                       tracer::LightChoice choice = tracer::LightChoice::tree,
                       std::shared_ptr<tracer::TextureCache> cache = nullptr,
                       const tracer::CoreSource& cores = {});

  const Scene& scene() const { return *scene_; }
  const tracer::Geometry& geometry() const { return geometry_; }
  const tracer::Materials& materials() const { return materials_; }
  const tracer::Bvh& bvh() const { return bvh_; }
  const tracer::Lights& lights() const { return lights_; }
  float diameter() const { return diameter_; }
  bool moves() const { return moves_; }              // something, while the shutter is open
  bool blends() const { return blends_; }            // there are surfaces that are there by chance
  bool parts_light() const { return parts_light_; }  // a light counts differently for diffuse and specular
  bool shows_unlit() const { return shows_unlit_; }

  // Where a point of a surface, as it is at the middle of the shutter, is `frames` later, or was.
  Vec3 frames_later(const tracer::Hit& hit, const Vec3& position, int frames) const;

 private:
  std::shared_ptr<const Scene> scene_;  // shared with the worker's cache of loaded scenes
  tracer::Shutter shutter_;
  tracer::Geometry geometry_;
  tracer::Materials materials_;
  tracer::Bvh bvh_;
  float diameter_;
  tracer::Lights lights_;
  bool moves_, blends_, shows_unlit_, parts_light_;
};

}  // namespace tessera
