// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/materials.h"

#include <fmt/format.h>

#include <cmath>

#include "core/scene/gltf/textures.h"
#include "core/scene/gltf/values.h"

namespace tessera::gltf {
namespace {

Color as_color(const std::vector<double>& v, const Color& otherwise) {
  if (v.size() < 3) return otherwise;
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

class Materials {
 public:
  Materials(Scene& scene, const Document& document)
      : scene_(scene), document_(document), textures_(scene, document) {}

  void add_all() {
    for (const tinygltf::Material& m : document_.model.materials) add(m);
    add({});
  }

 private:
  // Calls read(material, extension) if the material has the extension.
  template <class Read>
  void extend(Material& m, const tinygltf::Material& from, const char* name, const Read& read) {
    if (const tinygltf::Value* extension = find(from.extensions, std::string("KHR_materials_") + name))
      read(m, *extension);
  }

  void add(const tinygltf::Material& from) {
    Material m;
    m.name = from.name;
    read_core(m, from);
    extend(m, from, "pbrSpecularGlossiness", [&](auto& to, auto& e) { read_specular_glossiness(to, e); });
    extend(m, from, "emissive_strength",
           [](auto& to, auto& e) { to.emission *= number_or(e, "emissiveStrength", 1); });
    extend(m, from, "ior", [](auto& to, auto& e) { to.ior = number_or(e, "ior", 1.5f); });
    extend(m, from, "transmission", [&](auto& to, auto& e) { read_transmission(to, e); });
    extend(m, from, "volume", [&](auto& to, auto& e) { read_volume(to, e); });
    extend(m, from, "clearcoat", [&](auto& to, auto& e) { read_clearcoat(to, e); });
    extend(m, from, "sheen", [&](auto& to, auto& e) { read_sheen(to, e); });
    extend(m, from, "specular", [&](auto& to, auto& e) { warn_of_specular(to, e); });
    extend(m, from, "unlit", [](auto& to, auto&) { to.kind = Material::Kind::unlit; });
    document_.warn_of_unknown(scene_, from.extensions);
    scene_.materials.push_back(std::move(m));
  }

  // glTF 2.0, section 3.9. The occlusion texture has no use here: occlusion is traced.
  void read_core(Material& m, const tinygltf::Material& from) {
    const auto& pbr = from.pbrMetallicRoughness;
    m.kind = Material::Kind::metallic_roughness;
    m.base_color = as_color(pbr.baseColorFactor, Color(1));
    if (pbr.baseColorFactor.size() == 4) m.base_alpha = static_cast<float>(pbr.baseColorFactor[3]);
    m.metallic = static_cast<float>(pbr.metallicFactor);
    m.roughness = static_cast<float>(pbr.roughnessFactor);
    m.base_color_texture = textures_.read(pbr.baseColorTexture, Encoding::srgb, m.name);
    m.metallic_roughness_texture = textures_.read(pbr.metallicRoughnessTexture, Encoding::linear, m.name);
    m.normal_texture = textures_.read(from.normalTexture, Encoding::linear, m.name);
    m.normal_scale = static_cast<float>(from.normalTexture.scale);
    m.emission = as_color(from.emissiveFactor, Color(0));
    m.emission_texture = textures_.read(from.emissiveTexture, Encoding::srgb, m.name);
    m.alpha_cutoff = static_cast<float>(from.alphaCutoff);
    m.double_sided = from.doubleSided;
    if (from.alphaMode == "MASK") m.alpha = Material::Alpha::mask;
    if (from.alphaMode == "BLEND") m.alpha = Material::Alpha::blend;
  }

  void read_specular_glossiness(Material& m, const tinygltf::Value& e) {
    warn_here(m.name, "specular-glossiness is taken for a dielectric of that diffuse colour and glossiness");
    m.base_color = color_or(e, "diffuseFactor", Color(1));
    if (const tinygltf::Value* diffuse = find(e, "diffuseFactor");
        diffuse && diffuse->ArrayLen() == 4 && diffuse->Get(3).IsNumber())
      m.base_alpha = static_cast<float>(diffuse->Get(3).GetNumberAsDouble());
    m.base_color_texture = textures_.read(e, "diffuseTexture", Encoding::srgb, m.name);
    m.metallic = 0;
    m.roughness = 1 - number_or(e, "glossinessFactor", 1);
    m.metallic_roughness_texture = {};
  }

  // Without a volume the surface is a sheet that light passes unbent.
  void read_transmission(Material& m, const tinygltf::Value& e) {
    m.transmission = number_or(e, "transmissionFactor", 0);
    m.transmission_texture = textures_.read(e, "transmissionTexture", Encoding::linear, m.name);
    m.thin = true;
  }

  void read_volume(Material& m, const tinygltf::Value& e) {
    m.thin = !(number_or(e, "thicknessFactor", 0) > 0);
    m.attenuation_color = color_or(e, "attenuationColor", Color(1));
    m.attenuation_distance = number_or(e, "attenuationDistance", 0);  // missing: infinite, which is clear
    if (find(e, "thicknessTexture"))
      warn_here(m.name, "the thickness texture is ignored: light goes as far as the shape is thick");
  }

  void read_clearcoat(Material& m, const tinygltf::Value& e) {
    m.clearcoat = number_or(e, "clearcoatFactor", 0);
    m.clearcoat_texture = textures_.read(e, "clearcoatTexture", Encoding::linear, m.name);
    m.clearcoat_roughness = number_or(e, "clearcoatRoughnessFactor", 0);
    m.clearcoat_roughness_texture = textures_.read(e, "clearcoatRoughnessTexture", Encoding::linear, m.name);
    m.clearcoat_normal_texture = textures_.read(e, "clearcoatNormalTexture", Encoding::linear, m.name);
    if (const tinygltf::Value* normal = find(e, "clearcoatNormalTexture"))
      m.clearcoat_normal_scale = number_or(*normal, "scale", 1);
  }

  void read_sheen(Material& m, const tinygltf::Value& e) {
    m.sheen_color = color_or(e, "sheenColorFactor", Color(0));
    m.sheen_color_texture = textures_.read(e, "sheenColorTexture", Encoding::srgb, m.name);
    m.sheen_roughness = number_or(e, "sheenRoughnessFactor", 0);
    m.sheen_roughness_texture = textures_.read(e, "sheenRoughnessTexture", Encoding::linear, m.name);
  }

  void warn_of_specular(const Material& m, const tinygltf::Value& e) {
    if (number_or(e, "specularFactor", 1) != 1 || color_or(e, "specularColorFactor", Color(1)) != Color(1) ||
        find(e, "specularTexture") || find(e, "specularColorTexture"))
      warn_here(m.name, "KHR_materials_specular is ignored: the ior alone says how much it reflects");
  }

  void warn_here(std::string_view material, std::string_view what) {
    document_.warn(scene_, fmt::format("material '{}': {}", material, what));
  }

  Scene& scene_;
  const Document& document_;
  Textures textures_;
};

}  // namespace

void add_materials(Scene& scene, const Document& document) { Materials(scene, document).add_all(); }

}  // namespace tessera::gltf
