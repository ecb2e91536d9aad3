// SPDX-License-Identifier: Apache-2.0
#include "core/scene/obj.h"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <deque>

#include "core/error.h"
#include "core/scene/files.h"
#include "core/scene/import.h"
#include "core/scene/mtl.h"
#include "core/scene/pictures.h"

namespace tessera {
namespace {

constexpr std::uint64_t kMaxMtlBytes = 64ull << 20;

Vec3 as_vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

// What assimp gets to read: the OBJ itself, and material files only after a check (mtl.h). Nothing else.
class CheckedFiles : public Assimp::IOSystem {
 public:
  CheckedFiles(std::string obj, std::filesystem::path file, std::vector<std::string>& warnings)
      : obj_(std::move(obj)), file_(std::move(file)), warnings_(warnings) {
    if (obj_.find('\0') != std::string::npos)
      throw InputError(file_.string(), "this is no text", "Wavefront OBJ");
  }

  bool Exists(const char* name) const override { return is_obj(name) || is_file(name); }
  char getOsSeparator() const override { return '/'; }
  void Close(Assimp::IOStream* stream) override { delete stream; }

  Assimp::IOStream* Open(const char* name, const char*) override {
    if (is_obj(name)) return stream_of(obj_);
    const std::string shown = std::filesystem::path(name).filename().string();
    if (!is_file(name)) {
      warnings_.push_back(fmt::format("there is no material library '{}'", shown));
      return nullptr;
    }
    CheckedMtl mtl = checked_mtl(read_file(name, kMaxMtlBytes));
    for (const std::string& text : mtl.warnings) warnings_.push_back(fmt::format("{}:{}", shown, text));
    libraries_.push_back(std::move(mtl.text));
    return stream_of(libraries_.back());
  }

 private:
  bool is_obj(const char* name) const { return file_.string() == name; }
  static bool is_file(const char* name) {
    std::error_code error;
    return std::filesystem::is_regular_file(name, error);
  }
  static Assimp::IOStream* stream_of(const std::string& text) {
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  }

  std::string obj_;
  std::filesystem::path file_;
  std::deque<std::string> libraries_;
  std::vector<std::string>& warnings_;
};

class Converter {
 public:
  Converter(const aiScene& from, const std::filesystem::path& file)
      : from_(from), file_(file), shelf_(scene_) {}

  Scene convert() {
    scene_.name = file_.stem().string();
    for (unsigned m = 0; m < from_.mNumMaterials; ++m) add_material(*from_.mMaterials[m]);
    if (scene_.materials.empty()) scene_.materials.emplace_back();
    for (unsigned m = 0; m < from_.mNumMeshes; ++m) add_mesh(*from_.mMeshes[m]);
    return std::move(scene_);
  }

 private:
  void warn_here(std::string_view what) { warn(scene_, fmt::format("{}: {}", file_.string(), what)); }

  void add_material(const aiMaterial& from) {
    Material& m = scene_.materials.emplace_back();
    aiString name;
    if (from.Get(AI_MATKEY_NAME, name) == AI_SUCCESS) m.name = name.C_Str();
    aiColor3D color;
    if (from.Get(AI_MATKEY_COLOR_DIFFUSE, color) == AI_SUCCESS) m.base_color = {color.r, color.g, color.b};
    if (from.Get(AI_MATKEY_COLOR_EMISSIVE, color) == AI_SUCCESS) m.emission = {color.r, color.g, color.b};
    m.base_color_texture = texture_of(from, aiTextureType_DIFFUSE, Encoding::srgb);
    m.emission_texture = texture_of(from, aiTextureType_EMISSIVE, Encoding::srgb);
    // A texture stands for the colour where a file gives no factor, or the 0 that some programs write then.
    if (m.base_color_texture && m.base_color == Color(0)) m.base_color = Color(1);
    warn_of_losses(from, m.name);
  }

  Texture texture_of(const aiMaterial& from, aiTextureType type, Encoding encoding) {
    aiString path;
    if (from.GetTexture(type, 0, &path) != AI_SUCCESS || path.length == 0) return {};
    std::string relative = path.C_Str();
    std::replace(relative.begin(), relative.end(), '\\', '/');
    aiString name;
    from.Get(AI_MATKEY_NAME, name);
    const std::string where = fmt::format("{}: material '{}'", file_.string(), name.C_Str());
    return {shelf_.place(file_.parent_path() / relative, encoding, where)};
  }

  void warn_of_losses(const aiMaterial& from, std::string_view name) {
    float value = 1;
    if (from.Get(AI_MATKEY_OPACITY, value) == AI_SUCCESS && value < 1)
      warn_here(fmt::format("material '{}': the dissolve {} is ignored, it is opaque", name, value));
    aiColor3D specular(0, 0, 0);
    if (from.Get(AI_MATKEY_COLOR_SPECULAR, specular) == AI_SUCCESS && !specular.IsBlack())
      warn_here(fmt::format("material '{}': Ks is ignored, it is diffuse", name));
    for (int type = aiTextureType_DIFFUSE + 1; type <= aiTextureType_UNKNOWN; ++type)
      if (type != aiTextureType_EMISSIVE && from.GetTextureCount(static_cast<aiTextureType>(type)) > 0)
        warn_here(fmt::format("material '{}': a {} map is ignored", name,
                              aiTextureTypeToString(static_cast<aiTextureType>(type))));
  }

  void add_mesh(const aiMesh& from) {
    if ((from.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0)
      return warn_here("points and lines are left out");
    Mesh& mesh = scene_.meshes.emplace_back();
    mesh.name = from.mName.C_Str();
    if (from.mMaterialIndex < scene_.materials.size()) mesh.material = static_cast<int>(from.mMaterialIndex);
    for (unsigned v = 0; v < from.mNumVertices; ++v) {
      mesh.positions.push_back(as_vec3(from.mVertices[v]));
      if (from.HasNormals()) mesh.normals.push_back(as_vec3(from.mNormals[v]));
      if (from.HasTextureCoords(0))
        mesh.uvs.emplace_back(from.mTextureCoords[0][v].x, from.mTextureCoords[0][v].y);
    }
    for (unsigned f = 0; f < from.mNumFaces; ++f) {
      const aiFace& face = from.mFaces[f];
      if (face.mNumIndices != 3) continue;
      mesh.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
      for (const std::uint32_t v : mesh.triangles.back())
        if (v >= from.mNumVertices)
          throw InputError(file_.string(),
                           fmt::format("mesh '{}' uses vertex {} of {}", mesh.name, v, from.mNumVertices));
    }
    if (from.HasVertexColors(0)) warn_here("vertex colours are ignored");
    scene_.instances.push_back({static_cast<int>(scene_.meshes.size()) - 1, Matrix()});
  }

  const aiScene& from_;
  const std::filesystem::path& file_;
  Scene scene_;
  PictureShelf shelf_;
};

}  // namespace

Scene read_obj(const std::filesystem::path& file, const ImportLimits& limits, std::string_view where) {
  Assimp::Importer importer;
  std::vector<std::string> warnings;
  importer.SetIOHandler(
      new CheckedFiles(read_file(file, limits.file_bytes, where), file, warnings));  // the importer owns it
  const aiScene* read = nullptr;
  try {
    read = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                                aiProcess_SortByPType | aiProcess_FlipUVs);
  } catch (const std::exception& e) {
    throw InputError(file.string(), e.what(), "Wavefront OBJ");
  }
  if (!read) throw InputError(file.string(), importer.GetErrorString(), "Wavefront OBJ");
  Scene scene = Converter(*read, file).convert();
  for (const std::string& text : warnings) warn(scene, fmt::format("{}: {}", file.string(), text));
  return scene;
}

}  // namespace tessera
