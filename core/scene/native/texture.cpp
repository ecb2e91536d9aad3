// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "core/scene/native/parts.h"

namespace tessera {
namespace {

using Wrap = Texture::Wrap;
constexpr std::array<std::pair<std::string_view, Wrap>, 3> kWraps{
    {{"repeat", Wrap::repeat}, {"mirror", Wrap::mirror}, {"clamp", Wrap::clamp}}};

std::array<double, 2> pair_of(const Node& node, std::string_view key, double otherwise) {
  const Json* pair = node.json->find(key);
  if (!pair) return {otherwise, otherwise};
  return {pair->items()[0].number(), pair->items()[1].number()};
}

// KHR_texture_transform: translation * rotation * scale, where v points down, and so counter-clockwise takes
// (1, 0) to (cos, -sin).
std::array<float, 6> uv_transform(const Node& node) {
  std::array<float, 6> t;
  if (const Json* matrix = node.json->find("matrix")) {
    for (std::size_t i = 0; i < 6; ++i) t[i] = static_cast<float>(matrix->items()[i].number());
    return t;
  }
  const auto offset = pair_of(node, "offset", 0), scale = pair_of(node, "scale", 1);
  const double angle = node.has("rotation") ? node.at("rotation").json->number() * (kPi / 180) : 0;
  const double c = std::cos(angle), s = std::sin(angle);
  const std::array<double, 6> exact{c * scale[0],  s * scale[1], offset[0],
                                    -s * scale[0], c * scale[1], offset[1]};
  for (std::size_t i = 0; i < 6; ++i) t[i] = static_cast<float>(exact[i]);
  return t;
}

}  // namespace

void override_texture(Context& context, Texture& texture, const Node& material, std::string_view key,
                      Encoding encoding) {
  const auto node = material.find(key);
  if (!node) return;
  texture = {};
  if (node->json->is_null()) return;
  if (node->json->is_text()) {
    texture.picture = context.shelf.place(material.path(key), encoding, node->where());
    return;
  }
  const std::string wrap = node->text("wrap", "repeat");
  texture.picture = context.shelf.place(node->path("file"), encoding, node->at("file").where());
  texture.wrap_u = named(kWraps, node->text("wrap_u", wrap));
  texture.wrap_v = named(kWraps, node->text("wrap_v", wrap));
  texture.uv_set = static_cast<std::uint8_t>(node->integer("uv_set", 0));
  if (const auto transform = node->find("transform")) texture.transform = uv_transform(*transform);
}

}  // namespace tessera
