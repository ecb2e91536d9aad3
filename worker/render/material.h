// SPDX-License-Identifier: Apache-2.0
// What materials are at a point: their emission, their holes, and the scattering there.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "worker/render/geometry.h"
#include "worker/render/scattering.h"
#include "worker/render/texture.h"

namespace tessera::tracer {

// Where textures are looked up: the coordinates of a point in both sets.
struct TexturePoint {
  Vec2 uv, uv2;
  float width = 0;  // of what is seen there, in texture coordinates; 0: a point

  TexturePoint(const Vec2& only) : uv(only), uv2(only) {}  // of a shape that has one set
  TexturePoint(const Surface& s) : uv(s.uv), uv2(s.uv2) {}
  TexturePoint(const Geometry& g, const Hit& hit) : uv(g.uv(hit)), uv2(g.uv2(hit)) {}
};

class Materials {
 public:
  // `scene` is borrowed and must outlive this. Throws what Textures throws.
  explicit Materials(const Scene& scene, std::shared_ptr<TextureCache> cache = nullptr);

  const Textures& textures() const { return textures_; }

  // Its own emission, or that of what it is a mix of.
  bool emits(int material) const;
  // Radiance on the sides that emit.
  Color emission(int material, const TexturePoint&) const;
  Color mean_emission(int material) const;
  bool double_sided(int material) const { return (*this)[material].double_sided; }

  // Some of its points may not be there.
  bool masked(int material) const { return (*this)[material].alpha != Material::Alpha::opaque; }
  // How much of the surface is there: 0 or 1 for a mask, 0..1 for a blend. Pure: no chance involved.
  float opacity(const Geometry&, const Hit&) const;

  // The scattering at a hit of a ray along `direction`. Both sides scatter, whatever double_sided says, as in
  // Cycles. Nothing is scattered where the material is unlit.
  Bsdf bsdf(const Geometry&, const Hit&, const Surface&, const Vec3& direction) const;

  // What is most common scatters by Lambert's law and nothing else, and is faster to make than a Bsdf.
  bool lambert(int material) const { return plain_[static_cast<std::size_t>(material)].lambert; }
  struct Lambert {
    Vec3 ng, ns;  // on the side from which it is seen
    Color reflectance;
  };
  // Precondition: the surface's material is lambert().
  Lambert lambert(const Geometry&, const Hit&, const Surface&, const Vec3& direction) const;

  // Shows a colour whatever the light. In a mix, an unlit material is black.
  bool unlit(int material) const { return (*this)[material].kind == Material::Kind::unlit; }
  // The radiance that an unlit surface shows.
  Color shown(const Geometry&, const Hit&, const Surface&) const;

 private:
  struct View;
  // What most hits ask of a material, close together.
  struct Plain {
    bool lambert = false;
    bool textured = false;  // its base colour
    Color base_color;
  };
  const Material& operator[](int i) const { return scene_->materials[static_cast<std::size_t>(i)]; }
  // The only way to a texture's pixels.
  Texel texel(const Texture& texture, const TexturePoint& at) const;
  float channel(const Texture& texture, std::size_t channel, const TexturePoint& at) const;
  Color tinted(const Color& factor, const Texture& texture, const TexturePoint& at) const;
  Color base_color(const Material&, const Geometry&, const Hit&, const TexturePoint&) const;
  MaterialPoint at_point(const Material&, const View&) const;
  Vec3 mapped_normal(const Texture&, float scale, const View&) const;
  std::uint8_t facing(const Material&, const Texture&, float scale, View&, Bsdf&) const;
  void add(int material, float weight, View&, Bsdf&) const;
  void add_leaf(int material, float weight, View&, Bsdf&) const;

  const Scene* scene_;
  std::vector<Plain> plain_;  // by material
  Textures textures_;
  std::vector<bool> textured_;        // by material: looks something up at each point
  std::vector<float> mean_fresnel_;   // by material, of plastic
  std::optional<SheenAlbedo> sheen_;  // if a material has sheen
};

}  // namespace tessera::tracer
