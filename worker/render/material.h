// SPDX-License-Identifier: Apache-2.0
// What materials are at a point: their emission, their holes, and the scattering there.
#pragma once

#include "worker/render/bsdf/bsdf.h"
#include "worker/render/geometry.h"
#include "worker/render/texture.h"

namespace tessera::tracer {

class Materials {
 public:
  // `scene` is borrowed and must outlive this. Throws what Textures throws.
  explicit Materials(const Scene& scene, std::shared_ptr<TextureCache> cache = nullptr)
      : scene_(&scene), textures_(scene, std::move(cache)) {}

  const Textures& textures() const { return textures_; }

  bool emits(int material) const { return !is_black((*this)[material].emission); }
  bool masked(int material) const { return (*this)[material].alpha == Material::Alpha::mask; }
  // Radiance on the sides that emit.
  Color emission(int material, const Vec2& uv) const;
  bool unlit(int) const { return false; }
  Color shown(const Geometry&, const Hit&, const Surface&) const { return {0, 0, 0}; }
  Color mean_emission(int material) const;
  // False in the holes of an alpha mask: a cutoff, no chance involved.
  bool solid(int material, const Vec2& uv) const;
  // The scattering at a hit of a ray along `direction`. Both sides scatter, whatever double_sided says, as in
  // Cycles.
  Bsdf bsdf(const Geometry&, const Hit&, const Surface&, const Vec3& direction) const;
  bool double_sided(int material) const { return (*this)[material].double_sided; }

 private:
  const Material& operator[](int i) const { return scene_->materials[static_cast<std::size_t>(i)]; }
  Vec3 mapped_normal(const Material&, const Geometry&, const Hit&, const Surface&) const;

  const Scene* scene_;
  Textures textures_;
};

}  // namespace tessera::tracer
