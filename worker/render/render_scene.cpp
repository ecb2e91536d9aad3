// SPDX-License-Identifier: Apache-2.0
#include "worker/render/render_scene.h"

namespace tessera {
namespace {

float diameter_of(const tracer::Bvh& bvh) {
  const auto [low, high] = bvh.bounds();
  const float d = tracer::length(high - low);
  return d > 0 ? d : 1.0f;
}

}  // namespace

RenderScene::RenderScene(std::shared_ptr<const Scene> scene, tracer::Shutter shutter,
                         tracer::LightChoice choice)
    : scene_(std::move(scene)),
      geometry_(*scene_, shutter),
      materials_(*scene_),
      bvh_(
          geometry_, [this](int material) { return materials_.masked(material); },
          [this](const tracer::Hit& hit, std::uint32_t) {
            return materials_.solid(geometry_.material(hit), geometry_.uv(hit));
          }),
      diameter_(diameter_of(bvh_)),
      lights_(*scene_, geometry_, materials_, diameter_ / 2, choice) {}

std::shared_ptr<const RenderScene> prepare(std::shared_ptr<const Scene> scene) {
  return std::make_shared<RenderScene>(std::move(scene));
}

}  // namespace tessera
