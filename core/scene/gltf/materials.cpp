// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/scene/import.h"
#include "core/scene/pictures.h"

namespace tessera::gltf {
namespace {

constexpr std::array<std::string_view, 3> kKnown{"KHR_materials_emissive_strength", "KHR_materials_ior",
                                                 "KHR_materials_transmission"};

Color as_color(const std::vector<double>& v, const Color& otherwise) {
  if (v.size() < 3) return otherwise;
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Texture::Wrap as_wrap(int wrap) {
  if (wrap == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Texture::Wrap::clamp;
  if (wrap == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Texture::Wrap::mirror;
  return Texture::Wrap::repeat;
}

float extension_number(const tinygltf::ExtensionMap& extensions, const char* name, const char* key,
                       float otherwise) {
  const auto it = extensions.find(name);
  if (it == extensions.end() || !it->second.IsObject() || !it->second.Has(key)) return otherwise;
  const tinygltf::Value& value = it->second.Get(key);
  return value.IsNumber() ? static_cast<float>(value.GetNumberAsDouble()) : otherwise;
}

class Materials {
 public:
  Materials(Scene& scene, const Document& document) : scene_(scene), document_(document), shelf_(scene) {}

  void add_all() {
    for (const tinygltf::Material& m : document_.model.materials) add(m);
    add({});
  }

 private:
  void warn_here(std::string_view material, std::string_view what) {
    warn(scene_, fmt::format("{}: material '{}': {}", document_.file.string(), material, what));
  }

  void add(const tinygltf::Material& from) {
    const auto& pbr = from.pbrMetallicRoughness;
    Material m;
    m.name = from.name;
    m.kind = Material::Kind::metallic_roughness;
    m.base_color = as_color(pbr.baseColorFactor, Color(1));
    if (pbr.baseColorFactor.size() == 4) m.base_alpha = static_cast<float>(pbr.baseColorFactor[3]);
    m.metallic = static_cast<float>(pbr.metallicFactor);
    m.roughness = static_cast<float>(pbr.roughnessFactor);
    m.base_color_texture = texture(pbr.baseColorTexture, Encoding::srgb, m.name);
    m.metallic_roughness_texture = texture(pbr.metallicRoughnessTexture, Encoding::linear, m.name);
    m.normal_texture = texture(from.normalTexture, Encoding::linear, m.name);
    m.normal_scale = static_cast<float>(from.normalTexture.scale);
    m.emission =
        as_color(from.emissiveFactor, Color(0)) *
        extension_number(from.extensions, "KHR_materials_emissive_strength", "emissiveStrength", 1.0f);
    m.emission_texture = texture(from.emissiveTexture, Encoding::srgb, m.name);
    m.alpha_cutoff = static_cast<float>(from.alphaCutoff);
    m.ior = extension_number(from.extensions, "KHR_materials_ior", "ior", 1.5f);
    m.double_sided = from.doubleSided;
    set_alpha(m, from.alphaMode);
    set_transmission(m, from);
    warn_of_losses(from);
    scene_.materials.push_back(std::move(m));
  }

  void set_alpha(Material& m, const std::string& mode) {
    if (mode == "MASK") m.alpha = Material::Alpha::mask;
    if (mode == "BLEND") warn_here(m.name, "alphaMode BLEND is not supported, it is opaque");
  }

  void set_transmission(Material& m, const tinygltf::Material& from) {
    const float transmission =
        extension_number(from.extensions, "KHR_materials_transmission", "transmissionFactor", 0);
    if (transmission < 0.5f) {
      if (transmission > 0)
        warn_here(m.name, fmt::format("the transmission {} is ignored, it is opaque", transmission));
      return;
    }
    m.kind = Material::Kind::glass;
    warn_here(m.name, fmt::format("the transmission {} is taken for clear, smooth glass", transmission));
  }

  void warn_of_losses(const tinygltf::Material& from) {
    for (const auto& [name, value] : from.extensions)
      if (std::find(kKnown.begin(), kKnown.end(), name) == kKnown.end())
        warn_here(from.name, fmt::format("the extension {} is ignored", name));
    if (from.occlusionTexture.index >= 0)
      warn_here(from.name, "the occlusion texture is ignored: occlusion is traced");
  }

  template <class Info>
  Texture texture(const Info& info, Encoding encoding, std::string_view material) {
    if (info.index < 0) return {};
    const std::string part = fmt::format("textures/{}", info.index);
    const tinygltf::Model& model = document_.model;
    if (static_cast<std::size_t>(info.index) >= model.textures.size())
      document_.refuse(part, "there is no such texture");
    const tinygltf::Texture& from = model.textures[static_cast<std::size_t>(info.index)];
    if (from.source < 0) {
      warn_here(material, fmt::format("texture {} is left out: it has no image we know", info.index));
      return {};
    }
    if (info.texCoord != 0)
      warn_here(material, fmt::format("TEXCOORD_{} is taken for TEXCOORD_0", info.texCoord));
    for (const auto& [name, value] : info.extensions)
      warn_here(material, fmt::format("the extension {} is ignored", name));
    Texture result;
    result.picture = picture(from.source, encoding);
    if (from.sampler >= 0 && static_cast<std::size_t>(from.sampler) < model.samplers.size()) {
      result.wrap_u = as_wrap(model.samplers[static_cast<std::size_t>(from.sampler)].wrapS);
      result.wrap_v = as_wrap(model.samplers[static_cast<std::size_t>(from.sampler)].wrapT);
    }
    return result;
  }

  int picture(int image, Encoding encoding) {
    return shelf_.place(image_bytes(document_, image),
                        fmt::format("{}#images/{}", document_.file.string(), image), encoding);
  }

  Scene& scene_;
  const Document& document_;
  PictureShelf shelf_;
};

}  // namespace

void add_materials(Scene& scene, const Document& document) { Materials(scene, document).add_all(); }

}  // namespace tessera::gltf
