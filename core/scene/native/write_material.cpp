// SPDX-License-Identifier: Apache-2.0
#include "core/scene/native/material_fields.h"
#include "core/scene/native/metals.h"
#include "core/scene/native/write_parts.h"

namespace tessera {
namespace {

using Kind = Material::Kind;
using Wrap = Texture::Wrap;

template <class Table, class Value>
std::string name_in(const Table& table, const Value& value) {
  for (const auto& [name, known] : table)
    if (known == value) return std::string(name);
  return {};
}

std::string wrap_name(Wrap wrap) {
  return wrap == Wrap::repeat ? "repeat" : wrap == Wrap::mirror ? "mirror" : "clamp";
}

Json texture_json(const Scene& scene, const Texture& t, const std::filesystem::path& folder) {
  const std::string file = relative_to(folder, scene.pictures[static_cast<std::size_t>(t.picture)].name);
  Texture plain;
  plain.picture = t.picture;
  if (t == plain) return text(file);
  Members members;
  members.add("file", text(file));
  if (t.wrap_u == t.wrap_v && t.wrap_u != Wrap::repeat) members.add("wrap", text(wrap_name(t.wrap_u)));
  if (t.wrap_u != t.wrap_v) {
    members.add("wrap_u", text(wrap_name(t.wrap_u)));
    members.add("wrap_v", text(wrap_name(t.wrap_v)));
  }
  if (t.uv_set != 0) members.add("uv_set", number(t.uv_set));
  if (t.transform != plain.transform) {
    Members transform;
    transform.add("matrix", array_of(t.transform.data(), 6));
    members.add("transform", transform.done());
  }
  return members.done();
}

// What the reader starts from, and adds for the type.
Material standard_for(Kind kind) {
  Material standard;
  if (kind == Kind::glass || kind == Kind::plastic) standard.roughness = 0;
  return standard;
}

std::string metal_name(const Material& m) {
  if (m.kind == Kind::metal)
    for (const auto& [name, metal] : kMetals)
      if (metal.eta == m.eta && metal.k == m.k) return std::string(name);
  return {};
}

}  // namespace

Json material_json(const Scene& scene, const Names& names, const Material& m,
                   const std::filesystem::path& folder, bool with_textures) {
  Material standard = standard_for(m.kind);
  Members members;
  if (m.kind != Kind::diffuse) members.add("type", text(name_in(kKinds, m.kind)));
  if (const std::string metal = metal_name(m); !metal.empty()) {
    members.add("metal", text(metal));
    standard.eta = m.eta;
    standard.k = m.k;
  }
  for (const auto& [key, field] : kColors) members.add_color(std::string(key), m.*field, standard.*field);
  for (const auto& [key, field] : kNumbers) members.add_number(std::string(key), m.*field, standard.*field);
  for (const auto& [key, field] : kFlags)
    if (m.*field != standard.*field) members.add(std::string(key), {m.*field});
  if (m.alpha != standard.alpha) members.add("alpha_mode", text(name_in(kAlphas, m.alpha)));
  if (with_textures)
    for (const TextureField& t : kTextures)
      if (m.*t.field) members.add(std::string(t.key), texture_json(scene, m.*t.field, folder));
  if (m.kind == Kind::mix) {
    members.add("first", text(names.materials[static_cast<std::size_t>(m.first)]));
    members.add("second", text(names.materials[static_cast<std::size_t>(m.second)]));
  }
  return members.done();
}

}  // namespace tessera
