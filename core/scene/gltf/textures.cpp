// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/textures.h"

#include <fmt/format.h>

#include <cmath>

#include "core/scene/gltf/values.h"

namespace tessera::gltf {
namespace {

Texture::Wrap as_wrap(int wrap) {
  if (wrap == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Texture::Wrap::clamp;
  if (wrap == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Texture::Wrap::mirror;
  return Texture::Wrap::repeat;
}

// KHR_texture_transform: scaled, turned by `rotation` counter-clockwise as the picture is seen (v points
// down), then moved.
std::array<float, 6> transform_of(const tinygltf::Value& from) {
  const Vec2 offset = vec2_or(from, "offset", Vec2(0)), scale = vec2_or(from, "scale", Vec2(1));
  const double angle = number(from, "rotation").value_or(0);
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  return {c * scale.x, s * scale.y, offset.x, -s * scale.x, c * scale.y, offset.y};
}

}  // namespace

Texture Textures::read(const tinygltf::Value& extension, const std::string& key, Encoding encoding,
                       std::string_view material) {
  const tinygltf::Value* info = find(extension, key);
  if (!info || !info->IsObject()) return {};
  tinygltf::ExtensionMap extensions;
  if (const tinygltf::Value* all = find(*info, "extensions"); all && all->IsObject())
    extensions = all->Get<tinygltf::Value::Object>();
  return read(integer(*info, "index").value_or(-1), integer(*info, "texCoord").value_or(0), extensions,
              encoding, material);
}

Texture Textures::read(int index, int tex_coord, const tinygltf::ExtensionMap& extensions, Encoding encoding,
                       std::string_view material) {
  if (index < 0) return {};
  const tinygltf::Model& model = document_.model;
  const std::string part = fmt::format("textures/{}", index);
  const tinygltf::Texture& from =
      model.textures[checked(document_, index, model.textures.size(), "such texture", part)];
  document_.warn_of_unknown(scene_, from.extensions);
  document_.warn_of_unknown(scene_, extensions);
  const auto warn_here = [&](std::string_view what) {
    document_.warn(scene_, fmt::format("material '{}': {}", material, what));
  };
  if (from.source < 0) {
    warn_here(fmt::format("texture {} is left out: it has no image we know", index));
    return {};
  }
  Texture result;
  result.picture = place(from.source, encoding);
  if (from.sampler >= 0) {
    const auto& sampler = model.samplers[checked(document_, from.sampler, model.samplers.size(),
                                                 fmt::format("sampler {}", from.sampler), part)];
    result.wrap_u = as_wrap(sampler.wrapS);
    result.wrap_v = as_wrap(sampler.wrapT);
  }
  if (const tinygltf::Value* transform = find(extensions, "KHR_texture_transform")) {
    result.transform = transform_of(*transform);
    tex_coord = integer(*transform, "texCoord").value_or(tex_coord);
  }
  if (tex_coord < 0 || tex_coord > 1)
    warn_here(fmt::format("TEXCOORD_{} is taken for TEXCOORD_0", tex_coord));
  result.uv_set = tex_coord == 1 ? 1 : 0;
  return result;
}

int Textures::place(int index, Encoding encoding) {
  const std::string part = fmt::format("images/{}", index);
  const Image& image =
      document_.images[checked(document_, index, document_.images.size(), "such image", part)];
  const std::string where = fmt::format("{}#{}", document_.file.string(), part);
  const int placed =
      image.file.empty()
          ? shelf_.place(image.buffer_view >= 0 ? bytes_of(document_, image.buffer_view) : image.bytes, where,
                         encoding)
          : shelf_.place(image.file, encoding, where);
  for (; counted_ < scene_.pictures.size(); ++counted_) {
    const Picture& picture = scene_.pictures[counted_];
    pixels_ += static_cast<std::uint64_t>(picture.width) * static_cast<std::uint64_t>(picture.height);
  }
  require_at_most(document_.limits.picture_pixels, pixels_, "pixels in all pictures", where);
  return placed;
}

}  // namespace tessera::gltf
