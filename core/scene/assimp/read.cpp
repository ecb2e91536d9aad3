// SPDX-License-Identifier: Apache-2.0
#include "core/scene/assimp/read.h"

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <sstream>

#include "core/error.h"
#include "core/scene/assimp/files.h"
#include "core/scene/assimp/guard.h"
#include "core/scene/assimp/materials.h"
#include "core/scene/assimp/meshes.h"
#include "core/scene/assimp/nodes.h"
#include "core/scene/import.h"
#include "core/scene/roots.h"

namespace tessera {
namespace {

constexpr unsigned kProcessing =
    aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType | aiProcess_FlipUVs;

// Its readers hand on what a file says; its processing trusts that.
void check_indices(const aiScene& scene, const std::string& file) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f)
      for (unsigned i = 0; i < mesh.mFaces[f].mNumIndices; ++i)
        if (const unsigned v = mesh.mFaces[f].mIndices[i]; v >= mesh.mNumVertices)
          throw InputError(
              file, fmt::format("mesh '{}' uses vertex {} of {}", mesh.mName.C_Str(), v, mesh.mNumVertices));
  }
}

std::string_view format_of(const std::string& extension) {
  return extension == ".fbx" ? "Autodesk FBX" : "Wavefront OBJ";
}

void check(std::string_view bytes, const std::string& extension, const ImportLimits& limits,
           const std::string& file) {
  if (extension == ".obj") assimp::check_obj(bytes, file);
  if (extension == ".fbx") assimp::check_fbx(bytes, limits, file);
}

// assimp tries every reader it has on a file that its own does not know; only that one is left.
void keep_reader_of(Assimp::Importer& importer, const std::string& extension) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    std::istringstream all(importer.GetImporterInfo(i)->mFileExtensions);
    bool reads = false;
    for (std::string one; all >> one;) reads |= "." + one == extension;
    Assimp::BaseImporter* reader = importer.GetImporter(i);
    if (!reads && importer.UnregisterLoader(reader) == AI_SUCCESS) delete reader;
  }
}

// FBX counts in units of so many centimetres, along axes of its choice.
Matrix to_metres_and_y_up(const aiScene& scene) {
  const auto axis = [&](const std::string& name, int otherwise) {
    int index = otherwise, sign = 1;
    if (scene.mMetaData && scene.mMetaData->Get(name, index)) scene.mMetaData->Get(name + "Sign", sign);
    return std::pair(index, sign < 0 ? -1.0f : 1.0f);
  };
  const std::array<std::pair<int, float>, 3> axes{axis("CoordAxis", 0), axis("UpAxis", 1),
                                                  axis("FrontAxis", 2)};
  float centimetres = 1;
  if (scene.mMetaData) scene.mMetaData->Get("UnitScaleFactor", centimetres);
  const float metres = centimetres > 0 && centimetres < 1e9f ? centimetres / 100 : 0.01f;
  Matrix turn(0.0f), scale;
  turn[3][3] = 1;
  for (int i = 0; i < 3; ++i)
    if (const auto [index, sign] = axes[static_cast<std::size_t>(i)]; index >= 0 && index < 3)
      turn[index][i] = sign;
  scale.setScale(metres);
  return std::abs(turn.determinant()) > 0.5f ? scale * turn : scale;
}

}  // namespace

Scene read_with_assimp(const std::filesystem::path& named, const ImportLimits& limits,
                       std::string_view where) {
  const std::filesystem::path file = within(limits.roots, named, where);
  const std::string name = file.string(), extension = extension_of(file);
  std::string bytes = read_file(file, limits.file_bytes, where);
  check(bytes, extension, limits, name);
  Assimp::Importer importer;
  keep_reader_of(importer, extension);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  assimp::Libraries libraries;
  importer.SetIOHandler(
      new assimp::CheckedFiles(std::move(bytes), file, limits.roots, libraries));  // the importer owns it
  const aiScene* read = nullptr;
  try {
    read = importer.ReadFile(name, 0);
    if (read) check_indices(*read, name);
    if (read) read = importer.ApplyPostProcessing(kProcessing);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw InputError(name, e.what(), format_of(extension));
  }
  if (!read) throw InputError(name, importer.GetErrorString(), format_of(extension));
  Scene scene;
  scene.name = file.stem().string();
  scene.files = {name};
  scene.files.insert(scene.files.end(), libraries.files.begin(), libraries.files.end());
  assimp::add_materials(scene, *read, file, libraries.physical, limits);
  const std::vector<int> meshes = assimp::add_meshes(scene, *read, limits, name);
  assimp::add_nodes(scene, *read, meshes, extension == ".fbx" ? to_metres_and_y_up(*read) : Matrix(), limits,
                    name);
  for (const std::string& text : libraries.warnings) warn(scene, fmt::format("{}: {}", name, text));
  return scene;
}

}  // namespace tessera
