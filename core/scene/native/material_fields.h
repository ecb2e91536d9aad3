// SPDX-License-Identifier: Apache-2.0
// What the fields of a material are called in a native scene file: said once, for reading and for writing.
// Not here: the indices of a mix, which are names in the file.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "core/scene/pictures.h"
#include "core/scene/scene.h"

namespace tessera {

template <class Value, std::size_t N>
using FieldNames = std::array<std::pair<std::string_view, Value>, N>;

inline constexpr FieldNames<Material::Kind, 9> kKinds{
    {{"diffuse", Material::Kind::diffuse},
     {"mirror", Material::Kind::mirror},
     {"glass", Material::Kind::glass},
     {"metal", Material::Kind::metal},
     {"metallic_roughness", Material::Kind::metallic_roughness},
     {"translucent", Material::Kind::translucent},
     {"plastic", Material::Kind::plastic},
     {"mix", Material::Kind::mix},
     {"unlit", Material::Kind::unlit}}};

inline constexpr FieldNames<Material::Alpha, 3> kAlphas{{{"opaque", Material::Alpha::opaque},
                                                         {"mask", Material::Alpha::mask},
                                                         {"blend", Material::Alpha::blend}}};

inline constexpr FieldNames<float Material::*, 14> kNumbers{
    {{"metallic", &Material::metallic},
     {"roughness", &Material::roughness},
     {"normal_scale", &Material::normal_scale},
     {"alpha", &Material::base_alpha},
     {"alpha_cutoff", &Material::alpha_cutoff},
     {"ior", &Material::ior},
     {"exponent", &Material::exponent},
     {"transmission", &Material::transmission},
     {"attenuation_distance", &Material::attenuation_distance},
     {"clearcoat", &Material::clearcoat},
     {"clearcoat_roughness", &Material::clearcoat_roughness},
     {"clearcoat_normal_scale", &Material::clearcoat_normal_scale},
     {"sheen_roughness", &Material::sheen_roughness},
     {"mix", &Material::mix}}};

inline constexpr FieldNames<Color Material::*, 7> kColors{
    {{"color", &Material::base_color},
     {"emission", &Material::emission},
     {"eta", &Material::eta},
     {"k", &Material::k},
     {"transmission_color", &Material::transmission_color},
     {"attenuation_color", &Material::attenuation_color},
     {"sheen_color", &Material::sheen_color}}};

inline constexpr FieldNames<bool Material::*, 2> kFlags{
    {{"double_sided", &Material::double_sided}, {"thin", &Material::thin}}};

struct TextureField {
  std::string_view key;
  Texture Material::*field;
  Encoding encoding;
};
inline constexpr std::array kTextures{
    TextureField{"color_texture", &Material::base_color_texture, Encoding::srgb},
    TextureField{"metallic_roughness_texture", &Material::metallic_roughness_texture, Encoding::linear},
    TextureField{"normal_texture", &Material::normal_texture, Encoding::linear},
    TextureField{"emission_texture", &Material::emission_texture, Encoding::srgb},
    TextureField{"transmission_texture", &Material::transmission_texture, Encoding::linear},
    TextureField{"clearcoat_texture", &Material::clearcoat_texture, Encoding::linear},
    TextureField{"clearcoat_roughness_texture", &Material::clearcoat_roughness_texture, Encoding::linear},
    TextureField{"clearcoat_normal_texture", &Material::clearcoat_normal_texture, Encoding::linear},
    TextureField{"sheen_color_texture", &Material::sheen_color_texture, Encoding::srgb},
    TextureField{"sheen_roughness_texture", &Material::sheen_roughness_texture, Encoding::linear},
    TextureField{"mix_texture", &Material::mix_texture, Encoding::linear}};

}  // namespace tessera
