// SPDX-License-Identifier: Apache-2.0
// Primitives under KHR_draco_mesh_compression. Only for the files of this folder.
#pragma once

#include <memory>

#include "core/scene/gltf/accessor.h"

namespace draco {
class Mesh;
}

namespace tessera::gltf {

class DracoMesh {
 public:
  // Decodes what the extension of a primitive refers to; `document` is borrowed. Throws InputError at `part`.
  DracoMesh(const Document& document, const tinygltf::Value& extension, std::string part);
  ~DracoMesh();

  bool has(const std::string& attribute) const;  // "POSITION", ...
  // One element a point, of 1 to 4 components. `normalized` is what the accessor says.
  Floats floats(const std::string& attribute, bool normalized) const;
  std::size_t points() const;
  std::vector<std::uint32_t> indices() const;  // three a triangle, each below points()

 private:
  const Document& document_;
  const tinygltf::Value& extension_;
  std::string part_;
  std::unique_ptr<draco::Mesh> mesh_;
};

}  // namespace tessera::gltf
