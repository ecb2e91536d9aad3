// SPDX-License-Identifier: Apache-2.0
// Materials: numbers in range, textures that exist, mixes without an end refused.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/scene/finish_parts.h"
#include "core/scene/import.h"

namespace tessera::finishing {
namespace {

void clamp_core(const Context& c, Material& m, const std::string& owner) {
  c.clamp(m.base_color, 0, 1, owner, "base colour");
  c.clamp(m.metallic, 0, 1, owner, "metallic");
  c.clamp(m.roughness, 0, 1, owner, "roughness");
  c.clamp(m.normal_scale, -100, 100, owner, "normal scale");
  c.clamp(m.emission, 0, kMaxPower, owner, "emission");
  c.clamp(m.base_alpha, 0, 1, owner, "alpha");
  c.clamp(m.alpha_cutoff, 0, 1, owner, "alpha cutoff");
  c.clamp(m.ior, 1, 4, owner, "ior");
  c.clamp(m.eta, 0, 100, owner, "eta");
  c.clamp(m.k, 0, 100, owner, "k");
  c.clamp(m.exponent, 0, 1e6f, owner, "exponent");
}

void clamp_layers(const Context& c, Material& m, const std::string& owner) {
  c.clamp(m.transmission_color, 0, 1, owner, "transmission colour");
  c.clamp(m.transmission, 0, 1, owner, "transmission");
  c.clamp(m.attenuation_color, 0, 1, owner, "attenuation colour");
  c.clamp(m.attenuation_distance, 0, kMaxPower, owner, "attenuation distance");
  c.clamp(m.clearcoat, 0, 1, owner, "clearcoat");
  c.clamp(m.clearcoat_roughness, 0, 1, owner, "clearcoat roughness");
  c.clamp(m.clearcoat_normal_scale, -100, 100, owner, "clearcoat normal scale");
  c.clamp(m.sheen_color, 0, 1, owner, "sheen colour");
  c.clamp(m.sheen_roughness, 0, 1, owner, "sheen roughness");
  c.clamp(m.mix, 0, 1, owner, "mix");
}

// A sheet must not send on more light than it gets.
void balance_translucent(const Context& c, Material& m, const std::string& owner) {
  for (int i = 0; i < 3; ++i) {
    const float sum = m.base_color[i] + m.transmission_color[i];
    if (!(sum > 1)) continue;
    c.warn(fmt::format("{}: colour and transmission colour add up to {:g} and are scaled down to 1", owner,
                       sum));
    m.base_color[i] /= sum;
    m.transmission_color[i] = 1 - m.base_color[i];
  }
}

void check_texture(const Context& c, Texture& texture, const std::string& owner) {
  c.require_index(texture.picture, c.scene.pictures.size(), true, owner, "picture");
  if (texture.uv_set > 1)
    c.refuse(fmt::format("{}: there is no set {} of texture coordinates", owner, texture.uv_set), "0, 1");
  const auto usable = [](float v) { return std::abs(v) <= 1e6f; };
  if (std::all_of(texture.transform.begin(), texture.transform.end(), usable)) return;
  c.warn(fmt::format("{}: a texture transform with numbers beyond 1e6 is left out", owner));
  texture.transform = Texture{}.transform;
}

// Levels of mix from `index` down. A cycle is deeper than any limit.
int depth_of(const Context& c, int index, int left) {
  const Material& m = c.scene.materials[static_cast<std::size_t>(index)];
  if (m.kind != Material::Kind::mix || left < 0) return 0;
  const std::string owner = fmt::format("material '{}'", m.name);
  int deepest = 0;
  for (const int part : {m.first, m.second}) {
    c.require_index(part, c.scene.materials.size(), false, owner, "material");
    deepest = std::max(deepest, depth_of(c, part, left - 1));
  }
  return deepest + 1;
}

}  // namespace

void finish_materials(const Context& c) {
  for (Material& m : c.scene.materials) {
    const std::string owner = fmt::format("material '{}'", m.name);
    clamp_core(c, m, owner);
    clamp_layers(c, m, owner);
    if (m.kind == Material::Kind::translucent) balance_translucent(c, m, owner);
    for (Texture* texture : textures_of(m)) check_texture(c, *texture, owner);
  }
  for (std::size_t m = 0; m < c.scene.materials.size(); ++m)
    if (depth_of(c, static_cast<int>(m), kMaxMixDepth) > kMaxMixDepth)
      c.refuse(fmt::format("the material '{}' mixes materials in a circle or too deeply",
                           c.scene.materials[m].name),
               fmt::format("at most {} levels", kMaxMixDepth));
}

}  // namespace tessera::finishing
