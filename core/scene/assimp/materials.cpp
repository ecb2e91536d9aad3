// SPDX-License-Identifier: Apache-2.0
#include "core/scene/assimp/materials.h"

#include <assimp/ObjMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/scene/import.h"
#include "core/scene/pictures.h"
#include "core/scene/roots.h"

namespace tessera::assimp {
namespace {

std::optional<float> number(const aiMaterial& from, const char* key, unsigned type, unsigned index) {
  float value = 0;
  if (from.Get(key, type, index, value) != AI_SUCCESS) return {};
  return value;
}

std::optional<Color> color(const aiMaterial& from, const char* key, unsigned type, unsigned index) {
  aiColor3D value;
  if (from.Get(key, type, index, value) != AI_SUCCESS) return {};
  return Color(value.r, value.g, value.b);
}

// Walter et al. 2007, section 5.2: a Blinn-Phong exponent n is the GGX alpha sqrt(2 / (n + 2)); alpha is
// roughness^2.
float roughness_of(float exponent) { return std::sqrt(std::sqrt(2 / (std::max(exponent, 0.0f) + 2))); }

Texture::Wrap as_wrap(aiTextureMapMode mode) {
  if (mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal) return Texture::Wrap::clamp;
  return mode == aiTextureMapMode_Mirror ? Texture::Wrap::mirror : Texture::Wrap::repeat;
}

class Materials {
 public:
  Materials(Scene& scene, const aiScene& from, const std::filesystem::path& file,
            const std::set<std::string>& physical, const ImportLimits& limits)
      : scene_(scene),
        from_(from),
        file_(file),
        physical_(physical),
        limits_(limits),
        shelf_(scene, limits.roots) {}

  void add(const aiMaterial& from) {
    Material m;
    aiString name;
    if (from.Get(AI_MATKEY_NAME, name) == AI_SUCCESS) m.name = name.C_Str();
    if (const auto base = color(from, AI_MATKEY_BASE_COLOR))
      m.base_color = *base;
    else if (const auto diffuse = color(from, AI_MATKEY_COLOR_DIFFUSE))
      m.base_color = *diffuse;
    if (const auto emission = color(from, AI_MATKEY_COLOR_EMISSIVE)) m.emission = *emission;
    read_textures(m, from);
    read_scattering(m, from);
    read_opacity(m, from);
    // A texture stands for the colour where a file gives no factor, or the 0 that some programs write then.
    if (m.base_color_texture && m.base_color == Color(0)) m.base_color = Color(1);
    scene_.materials.push_back(std::move(m));
  }

 private:
  void warn_here(const Material& m, std::string_view what) {
    warn(scene_, fmt::format("{}: material '{}': {}", file_.string(), m.name, what));
  }

  // What scatters: by metalness and roughness where they are given, else by the illumination model of MTL
  // (mirrors from 3, glass at 4, 6, 7 and 9), else by the highlight.
  void read_scattering(Material& m, const aiMaterial& from) {
    const Color specular = color(from, AI_MATKEY_COLOR_SPECULAR).value_or(Color(0)) *
                           number(from, AI_MATKEY_SHININESS_STRENGTH).value_or(1);
    const float exponent = number(from, AI_MATKEY_SHININESS)
                               .value_or(number(from, "$raw.Shininess", 0, 0).value_or(0));  // of FBX
    const float ior = number(from, AI_MATKEY_REFRACTI).value_or(0);
    if (ior > 1) m.ior = ior;
    int illum = -1;
    from.Get(AI_MATKEY_OBJ_ILLUM, illum);
    if (is_physical(m, from)) {
      m.kind = Material::Kind::metallic_roughness;
      m.metallic = number(from, AI_MATKEY_METALLIC_FACTOR).value_or(0);
      m.roughness = number(from, AI_MATKEY_ROUGHNESS_FACTOR).value_or(1);
    } else if (illum == 5) {
      m.kind = Material::Kind::mirror;
      m.base_color = specular;
    } else if (illum == 4 || illum == 6 || illum == 7 || illum == 9) {
      m.kind = Material::Kind::glass;
      m.roughness = 0;
      m.base_color = color(from, AI_MATKEY_COLOR_TRANSPARENT).value_or(Color(1));
      if (m.base_color == Color(0)) m.base_color = Color(1);
    } else if (illum == 3 || illum == 8) {
      m.kind = Material::Kind::metallic_roughness;
      m.metallic = std::max({specular.x, specular.y, specular.z});
      m.roughness = roughness_of(exponent);
    } else if (specular != Color(0) && exponent > 0 && illum != 0 && illum != 1) {
      m.kind = Material::Kind::plastic;
      m.roughness = roughness_of(exponent);
    } else if (specular != Color(0) && illum >= 0) {
      warn_here(m, fmt::format("Ks is ignored: with illum {} it is diffuse", illum));
    }
  }

  // FBX writes no metalness unless it is meant; of MTL assimp hands on a 0 for one that is not there.
  bool is_physical(const Material& m, const aiMaterial& from) const {
    int illum = -1;
    if (from.Get(AI_MATKEY_OBJ_ILLUM, illum) == AI_SUCCESS) return physical_.contains(m.name);
    return number(from, AI_MATKEY_METALLIC_FACTOR).has_value();
  }

  void read_opacity(Material& m, const aiMaterial& from) {
    const float opacity = number(from, AI_MATKEY_OPACITY).value_or(1);
    aiString base, mask;
    const bool has_mask = from.GetTexture(aiTextureType_OPACITY, 0, &mask) == AI_SUCCESS;
    const bool same =
        has_mask && from.GetTexture(aiTextureType_DIFFUSE, 0, &base) == AI_SUCCESS && base == mask;
    if (has_mask && !same)
      warn_here(m, "the opacity map is ignored: transparency is read from the alpha of the colour map");
    if (m.kind == Material::Kind::glass || !(opacity < 1 || same)) return;
    m.alpha = Material::Alpha::blend;
    m.base_alpha = opacity;
  }

  void read_textures(Material& m, const aiMaterial& from) {
    m.base_color_texture = texture(m, from, aiTextureType_BASE_COLOR, Encoding::srgb);
    if (!m.base_color_texture) m.base_color_texture = texture(m, from, aiTextureType_DIFFUSE, Encoding::srgb);
    m.emission_texture = texture(m, from, aiTextureType_EMISSIVE, Encoding::srgb);
    m.normal_texture = texture(m, from, aiTextureType_NORMALS, Encoding::linear);
    for (int t = aiTextureType_DIFFUSE + 1; t <= aiTextureType_UNKNOWN; ++t) {
      const auto type = static_cast<aiTextureType>(t);
      const bool known = type == aiTextureType_BASE_COLOR || type == aiTextureType_EMISSIVE ||
                         type == aiTextureType_NORMALS || type == aiTextureType_OPACITY;
      if (!known && from.GetTextureCount(type) > 0)
        warn_here(m, fmt::format("a {} map is ignored", aiTextureTypeToString(type)));
    }
  }

  Texture texture(const Material& m, const aiMaterial& from, aiTextureType type, Encoding encoding) {
    aiString path;
    unsigned set = 0;
    aiTextureMapMode modes[2] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    if (from.GetTexture(type, 0, &path, nullptr, &set, nullptr, nullptr, modes) != AI_SUCCESS ||
        path.length == 0)
      return {};
    Texture result;
    result.picture = place(path, encoding, fmt::format("{}: material '{}'", file_.string(), m.name));
    if (result.picture < 0) {
      warn_here(m, fmt::format("the embedded picture '{}' is not encoded and left out", path.C_Str()));
      return {};
    }
    result.wrap_u = as_wrap(modes[0]), result.wrap_v = as_wrap(modes[1]);
    result.uv_set = set == 1 ? 1 : 0;
    aiUVTransform transform;
    if (from.Get(AI_MATKEY_UVTRANSFORM(type, 0), transform) == AI_SUCCESS &&
        (transform.mRotation != 0 || transform.mScaling != aiVector2D(1, 1) ||
         transform.mTranslation != aiVector2D(0, 0)))
      warn_here(m, "the transform of a texture is ignored");
    return result;
  }

  // -1 for an embedded picture of bare pixels.
  int place(const aiString& path, Encoding encoding, const std::string& where) {
    int placed = -1;
    if (const aiTexture* embedded = from_.GetEmbeddedTexture(path.C_Str())) {
      if (embedded->mHeight != 0) return -1;
      placed = shelf_.place({reinterpret_cast<const unsigned char*>(embedded->pcData), embedded->mWidth},
                            fmt::format("{}#{}", file_.string(), path.C_Str()), encoding);
    } else {
      placed = shelf_.place(found(path), encoding, where);
    }
    std::uint64_t pixels = 0;
    for (const Picture& p : scene_.pictures)
      pixels += static_cast<std::uint64_t>(p.width) * static_cast<std::uint64_t>(p.height);
    require_at_most(limits_.picture_pixels, pixels, "pixels in all pictures", where);
    return placed;
  }

  // Files carry paths of the machine they were made on: then one of that name beside the file is meant.
  std::filesystem::path found(const aiString& path) const {
    std::string relative = path.C_Str();
    std::replace(relative.begin(), relative.end(), '\\', '/');
    const std::filesystem::path folder = file_.parent_path(), named = folder / relative,
                                beside = folder / named.filename();
    const auto is_there = [&](const std::filesystem::path& file) {
      std::error_code error;
      return lies_within(limits_.roots, file) && std::filesystem::exists(file, error);
    };
    return !is_there(named) && is_there(beside) ? beside : named;
  }

  Scene& scene_;
  const aiScene& from_;
  const std::filesystem::path& file_;
  const std::set<std::string>& physical_;
  const ImportLimits& limits_;
  PictureShelf shelf_;
};

}  // namespace

void add_materials(Scene& scene, const aiScene& from, const std::filesystem::path& file,
                   const std::set<std::string>& physical, const ImportLimits& limits) {
  Materials materials(scene, from, file, physical, limits);
  for (unsigned m = 0; m < from.mNumMaterials; ++m) materials.add(*from.mMaterials[m]);
  if (scene.materials.empty()) scene.materials.emplace_back();
}

}  // namespace tessera::assimp
