// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "core/error.h"
#include "core/scene/native/material_fields.h"
#include "core/scene/native/metals.h"
#include "core/scene/native/parts.h"

namespace tessera {
namespace {

using Kind = Material::Kind;

void read_kind(Material& m, const Node& node) {
  const Kind before = m.kind;
  if (node.has("metal")) m.kind = Kind::metal;
  if (node.has("type")) m.kind = named(kKinds, node.text("type", {}));
  if (m.kind != before && (m.kind == Kind::glass || m.kind == Kind::plastic)) m.roughness = 0;
  const auto metal = node.find("metal");
  if (!metal) return;
  if (m.kind != Kind::metal)
    throw InputError(metal->where(), fmt::format("'metal' means nothing to {}", node.text("type", {})),
                     "the type metal, or none");
  const Metal constants = named(kMetals, metal->json->text());
  m.eta = constants.eta;
  m.k = constants.k;
}

void require_no_gain(const Material& m, const Node& node) {
  if (m.kind != Kind::translucent) return;
  for (int c = 0; c < 3; ++c)
    if (m.base_color[c] + m.transmission_color[c] > 1 + 1e-6f)
      throw InputError(node.where(),
                       fmt::format("color and transmission_color add up to {:g}",
                                   m.base_color[c] + m.transmission_color[c]),
                       "at most 1 in each channel");
}

}  // namespace

void override_material(Context& context, Material& m, const Node& node) {
  read_kind(m, node);
  for (const auto& [key, field] : kNumbers) m.*field = node.number(key, m.*field);
  for (const auto& [key, field] : kColors) m.*field = node.color(key, m.*field);
  for (const auto& [key, field] : kFlags) m.*field = node.flag(key, m.*field);
  for (const TextureField& t : kTextures) override_texture(context, m.*t.field, node, t.key, t.encoding);
  if (node.has("alpha_mode")) m.alpha = named(kAlphas, node.text("alpha_mode", {}));
  require_no_gain(m, node);
}

}  // namespace tessera
