// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <utility>

#include "core/scene/native/parts.h"

namespace tessera {
namespace {

template <class Value, std::size_t N>
Value named(const std::array<std::pair<std::string_view, Value>, N>& table, std::string_view name) {
  for (const auto& [known, value] : table)
    if (known == name) return value;
  throw std::logic_error("the schema let through a name the reader does not know: " + std::string(name));
}

using Kind = Material::Kind;
constexpr std::array<std::pair<std::string_view, Kind>, 5> kKinds{
    {{"diffuse", Kind::diffuse},
     {"mirror", Kind::mirror},
     {"glass", Kind::glass},
     {"metal", Kind::metal},
     {"metallic_roughness", Kind::metallic_roughness}}};

using Wrap = Texture::Wrap;
constexpr std::array<std::pair<std::string_view, Wrap>, 3> kWraps{
    {{"repeat", Wrap::repeat}, {"mirror", Wrap::mirror}, {"clamp", Wrap::clamp}}};

void override_texture(Texture& texture, const Node& material, std::string_view key, Encoding encoding,
                      PictureShelf& shelf) {
  const auto node = material.find(key);
  if (!node) return;
  texture = {};
  if (node->json->is_null()) return;
  if (node->json->is_text()) {
    texture.picture = shelf.place(material.path(key), encoding, node->where());
    return;
  }
  const std::string wrap = node->text("wrap", "repeat");
  texture.picture = shelf.place(node->path("file"), encoding, node->at("file").where());
  texture.wrap_u = named(kWraps, node->text("wrap_u", wrap));
  texture.wrap_v = named(kWraps, node->text("wrap_v", wrap));
}

}  // namespace

void override_material(Material& m, const Node& node, PictureShelf& shelf) {
  if (node.has("type")) m.kind = named(kKinds, node.text("type", {}));
  m.base_color = node.color("color", m.base_color);
  override_texture(m.base_color_texture, node, "color_texture", Encoding::srgb, shelf);
  m.metallic = node.number("metallic", m.metallic);
  m.roughness = node.number("roughness", m.roughness);
  override_texture(m.metallic_roughness_texture, node, "metallic_roughness_texture", Encoding::linear, shelf);
  override_texture(m.normal_texture, node, "normal_texture", Encoding::linear, shelf);
  m.normal_scale = node.number("normal_scale", m.normal_scale);
  m.emission = node.color("emission", m.emission);
  override_texture(m.emission_texture, node, "emission_texture", Encoding::srgb, shelf);
  if (node.has("alpha_mode"))
    m.alpha = node.text("alpha_mode", {}) == "mask" ? Material::Alpha::mask : Material::Alpha::opaque;
  m.base_alpha = node.number("alpha", m.base_alpha);
  m.alpha_cutoff = node.number("alpha_cutoff", m.alpha_cutoff);
  m.ior = node.number("ior", m.ior);
  m.eta = node.color("eta", m.eta);
  m.k = node.color("k", m.k);
  m.double_sided = node.flag("double_sided", m.double_sided);
}

}  // namespace tessera
