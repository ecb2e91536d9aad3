// SPDX-License-Identifier: Apache-2.0
#include "core/scene/assimp/meshes.h"

#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "core/scene/import.h"
#include "core/scene/srgb.h"

namespace tessera::assimp {
namespace {

Vec3 as_vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

std::vector<Vec2> uvs_of(const aiMesh& from, unsigned set) {
  std::vector<Vec2> uvs;
  for (unsigned v = 0; from.HasTextureCoords(set) && v < from.mNumVertices; ++v)
    uvs.emplace_back(from.mTextureCoords[set][v].x, from.mTextureCoords[set][v].y);
  return uvs;
}

void read_triangles(Mesh& mesh, const aiMesh& from) {
  for (unsigned f = 0; f < from.mNumFaces; ++f) {
    const aiFace& face = from.mFaces[f];
    if (face.mNumIndices == 3)
      mesh.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
  }
}

void warn_of_losses(Scene& scene, const aiMesh& from, const std::string& file) {
  const auto warn_here = [&](std::string_view what) { warn(scene, fmt::format("{}: {}", file, what)); };
  if (from.HasBones()) warn_here("skins are ignored: meshes stay in their bind pose");
  if (from.mNumAnimMeshes > 0) warn_here("morph targets are ignored: meshes stay in their base shape");
  if (from.HasVertexColors(1)) warn_here("more than one set of vertex colours: the first is used");
  if (from.HasTextureCoords(2))
    warn_here("more than two sets of texture coordinates: the first two are used");
}

Mesh mesh_of(const Scene& scene, const aiMesh& from) {
  Mesh mesh;
  mesh.name = from.mName.C_Str();
  if (from.mMaterialIndex < scene.materials.size()) mesh.material = static_cast<int>(from.mMaterialIndex);
  for (unsigned v = 0; v < from.mNumVertices; ++v) {
    mesh.positions.push_back(as_vec3(from.mVertices[v]));
    if (from.HasNormals()) mesh.normals.push_back(as_vec3(from.mNormals[v]));
    if (!from.HasVertexColors(0)) continue;
    const aiColor4D& c = from.mColors[0][v];  // sRGB: what the programs show that write them
    mesh.colors.push_back({from_srgb(c.r), from_srgb(c.g), from_srgb(c.b), c.a});
  }
  mesh.uvs = uvs_of(from, 0);
  mesh.uvs2 = uvs_of(from, 1);
  read_triangles(mesh, from);
  return mesh;
}

}  // namespace

std::vector<int> add_meshes(Scene& scene, const aiScene& from, const ImportLimits& limits,
                            const std::string& file) {
  std::uint64_t vertices = 0, triangles = 0;
  for (unsigned m = 0; m < from.mNumMeshes; ++m) {
    require_at_most(limits.vertices, vertices += from.mMeshes[m]->mNumVertices, "vertices", file);
    require_at_most(limits.triangles, triangles += from.mMeshes[m]->mNumFaces, "triangles", file);
  }
  std::vector<int> indices;
  for (unsigned m = 0; m < from.mNumMeshes; ++m) {
    const bool has_triangles = (from.mMeshes[m]->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) != 0;
    indices.push_back(has_triangles ? static_cast<int>(scene.meshes.size()) : -1);
    if (!has_triangles) {
      warn(scene, fmt::format("{}: points and lines are left out", file));
      continue;
    }
    scene.meshes.push_back(mesh_of(scene, *from.mMeshes[m]));
    warn_of_losses(scene, *from.mMeshes[m], file);
  }
  return indices;
}

}  // namespace tessera::assimp
