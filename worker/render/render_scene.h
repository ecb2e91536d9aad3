// SPDX-License-Identifier: Apache-2.0
// A scene and everything derived from it that tracing needs.
#pragma once

#include "worker/render/bvh.h"
#include "worker/render/light/lights.h"
#include "worker/render/material.h"
#include "worker/render/render.h"

namespace tessera {

class RenderScene {
 public:
  explicit RenderScene(std::shared_ptr<const Scene> scene, tracer::Shutter shutter = {},
                       tracer::LightChoice choice = tracer::LightChoice::tree);

  const Scene& scene() const { return *scene_; }
  const tracer::Geometry& geometry() const { return geometry_; }
  const tracer::Materials& materials() const { return materials_; }
  const tracer::Bvh& bvh() const { return bvh_; }
  const tracer::Lights& lights() const { return lights_; }
  float diameter() const { return diameter_; }

 private:
  std::shared_ptr<const Scene> scene_;  // shared with the worker's cache of loaded scenes
  tracer::Geometry geometry_;
  tracer::Materials materials_;
  tracer::Bvh bvh_;
  float diameter_;
  tracer::Lights lights_;
};

}  // namespace tessera
