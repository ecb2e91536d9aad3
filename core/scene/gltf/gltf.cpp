// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/gltf.h"

#include <fmt/format.h>

#include "core/scene/gltf/document.h"
#include "core/scene/gltf/materials.h"
#include "core/scene/gltf/meshes.h"
#include "core/scene/gltf/nodes.h"

namespace tessera {

Scene read_gltf(const std::filesystem::path& file, const ImportLimits& limits, std::string_view where) {
  const gltf::Document document = gltf::open(file, limits, where);
  Scene scene;
  scene.name = file.stem().string();
  scene.files = document.files;
  tinygltf::ExtensionMap used;
  for (const std::string& name : document.model.extensionsUsed) used[name];
  document.warn_of_unknown(scene, used);
  gltf::add_materials(scene, document);
  gltf::add_nodes(scene, document, gltf::add_meshes(scene, document));
  return scene;
}

}  // namespace tessera
