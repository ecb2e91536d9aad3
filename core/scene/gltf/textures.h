// SPDX-License-Identifier: Apache-2.0
// The textures of a glTF file: pictures, samplers and KHR_texture_transform. Only for the files of this
// folder.
#pragma once

#include "core/scene/gltf/document.h"
#include "core/scene/pictures.h"

namespace tessera::gltf {

class Textures {
 public:
  Textures(Scene& scene, const Document& document)
      : scene_(scene), document_(document), shelf_(scene, document.limits.roots) {}

  // Of a textureInfo of the core material, or of an extension (one that is not there: no texture).
  // `material` names the user, for warnings.
  template <class Info>
  Texture read(const Info& info, Encoding encoding, std::string_view material) {
    return read(info.index, info.texCoord, info.extensions, encoding, material);
  }
  Texture read(const tinygltf::Value& extension, const std::string& key, Encoding, std::string_view material);

 private:
  Texture read(int index, int tex_coord, const tinygltf::ExtensionMap&, Encoding, std::string_view material);
  int place(int image, Encoding encoding);

  Scene& scene_;
  const Document& document_;
  PictureShelf shelf_;
  std::uint64_t pixels_ = 0;  // of all pictures of the scene
  std::size_t counted_ = 0;   // pictures in pixels_
};

}  // namespace tessera::gltf
