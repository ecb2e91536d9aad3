// SPDX-License-Identifier: Apache-2.0
#include "worker/render/render_scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/scene/load.h"
#include "worker/render/sampler.h"

namespace tessera {
namespace {

float diameter_of(const tracer::Bvh& bvh) {
  const auto [low, high] = bvh.bounds();
  const float d = tracer::length(high - low);
  return d > 0 ? d : 1.0f;
}

// Of the frame's camera; always the same where nothing can move.
tracer::Shutter shutter_for(const Scene& scene, const RenderSettings& settings, int frame) {
  if (scene.tracks.empty()) return {};
  const auto camera = static_cast<std::size_t>(camera_index(scene, settings.camera));
  return tracer::shutter_of(scene, scene.cameras[camera], frame);
}

bool weighs_lobes(const Scene& scene) {
  const auto parts = [](const auto& thing) { return thing.light.diffuse != 1 || thing.light.specular != 1; };
  const auto any = [&](const auto& things) { return std::any_of(things.begin(), things.end(), parts); };
  return any(scene.points) || any(scene.spots) || any(scene.suns) || any(scene.objects) ||
         parts(scene.environment);
}

// The scene with the materials of a variant.
std::shared_ptr<const Scene> varied(std::shared_ptr<const Scene> scene, std::string_view name) {
  const Variant* variant = variant_of(*scene, name);
  if (!variant) return scene;
  auto other = std::make_shared<Scene>(*scene);
  for (const Variant::Choice& c : variant->choices)
    other->meshes[static_cast<std::size_t>(c.mesh)].material = c.material;
  return other;
}

// Whether a surface of this opacity is there for a ray. Every ray and every surface decides for itself.
bool there(float opacity, const tracer::Hit& hit, std::uint32_t seed) {
  if (opacity >= 1) return true;
  const std::uint64_t key = static_cast<std::uint64_t>(hit.piece) << 32 | hit.primitive;
  return tracer::unit_float(static_cast<std::uint32_t>(tracer::mixed(tracer::mixed(key) ^ seed) >> 32)) <
         opacity;
}

std::shared_ptr<const tracer::BvhCore> core_of(const tracer::Geometry& geometry,
                                               const std::function<bool(int)>& masked,
                                               const tracer::CoreSource& cores) {
  return cores ? cores(geometry, masked) : std::make_shared<const tracer::BvhCore>(geometry, masked);
}

bool any_material(const Scene& scene, const auto& is) {
  return std::any_of(scene.materials.begin(), scene.materials.end(), is);
}

}  // namespace

tracer::Shutter tracer::shutter_of(const Scene& scene, const Camera& camera, double frame) {
  const double fps = scene.frames_per_second;
  return {(frame + double(camera.shutter_open)) / fps, (frame + double(camera.shutter_close)) / fps};
}

RenderScene::RenderScene(std::shared_ptr<const Scene> scene, tracer::Shutter shutter,
                         tracer::LightChoice choice, std::shared_ptr<tracer::TextureCache> cache,
                         const tracer::CoreSource& cores)
    : scene_(std::move(scene)),
      shutter_(shutter),
      geometry_(*scene_, shutter),
      materials_(*scene_, std::move(cache)),
      bvh_(geometry_,
           core_of(
               geometry_, [this](int material) { return materials_.masked(material); }, cores),
           [this](const tracer::Hit& hit, std::uint32_t seed) {
             return there(materials_.opacity(geometry_, hit), hit, seed);
           }),
      diameter_(diameter_of(bvh_)),
      lights_(*scene_, geometry_, materials_, diameter_ / 2, choice),
      moves_(false),
      blends_(any_material(*scene_, [](const Material& m) { return m.alpha == Material::Alpha::blend; })),
      shows_unlit_(any_material(*scene_, [](const Material& m) { return m.kind == Material::Kind::unlit; })),
      parts_light_(weighs_lobes(*scene_)) {
  for (std::uint32_t i = 0; i < geometry_.pieces.size(); ++i) moves_ |= geometry_.steps(i) > 1;
}

Vec3 RenderScene::frames_later(const tracer::Hit& hit, const Vec3& position, int frames) const {
  const int object = geometry_.object(hit);
  if (object < 0 || scene_->objects[static_cast<std::size_t>(object)].track < 0) return position;
  const double middle = (shutter_.open + shutter_.close) / 2;
  const Matrix now = geometry_.to_world(hit.piece, 0.5f);
  const Matrix then = geometry_.to_world_at(hit.piece, middle + frames / double(scene_->frames_per_second));
  return tracer::moved(tracer::moved(position, now.inverse()), then);
}

std::shared_ptr<const RenderScene> prepare(std::shared_ptr<const Scene> scene, const RenderSettings& settings,
                                           int frame, std::shared_ptr<tracer::TextureCache> cache,
                                           const tracer::CoreSource& cores) {
  const tracer::Shutter shutter = shutter_for(*scene, settings, frame);
  return std::make_shared<RenderScene>(varied(std::move(scene), settings.variant), shutter,
                                       tracer::LightChoice::tree, std::move(cache), cores);
}

std::string preparation(const Scene& scene, const RenderSettings& settings, int frame) {
  const tracer::Shutter shutter = shutter_for(scene, settings, frame);
  return fmt::format("{} {} {}", settings.variant, shutter.open, shutter.close);
}

void require_sound_textures(const RenderScene& scene) { scene.materials().textures().require_sound(); }

}  // namespace tessera
