// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/scene/gltf/draco.h"
#include "core/scene/gltf/values.h"

namespace tessera::gltf {
namespace {

using Indices = std::vector<std::uint32_t>;

// Corners of triangles from those of a strip or a fan (glTF 2.0, section 3.7.2.1).
Indices as_triangles(const Indices& from, int mode) {
  if (mode != TINYGLTF_MODE_TRIANGLE_STRIP && mode != TINYGLTF_MODE_TRIANGLE_FAN) return from;
  Indices to;
  for (std::size_t i = 0; i + 2 < from.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
      to.insert(to.end(), {from[i + 1], from[i + 2], from[0]});
    else
      to.insert(to.end(), {from[i], from[i + 1 + i % 2], from[i + 2 - i % 2]});
  }
  return to;
}

// One primitive as a mesh.
class Primitive {
 public:
  Primitive(Scene& scene, const Document& document, const tinygltf::Primitive& from, std::string part)
      : scene_(scene), document_(document), from_(from), part_(std::move(part)) {}

  Mesh read() {
    check_counts();
    if (const tinygltf::Value* compressed = find(from_.extensions, "KHR_draco_mesh_compression"))
      draco_.emplace(document_, *compressed, part_);
    if (draco_)
      require_at_most(document_.limits.vertices, draco_->points(), "vertices", document_.file.string());
    const Floats positions = attribute("POSITION", {TINYGLTF_TYPE_VEC3});
    mesh_.positions.resize(positions.count());
    for (std::size_t v = 0; v < positions.count(); ++v) mesh_.positions[v] = vec3(positions.at(v));
    read_normals();
    mesh_.uvs = read_uvs("TEXCOORD_0");
    mesh_.uvs2 = read_uvs("TEXCOORD_1");
    read_colors();
    read_triangles();
    mesh_.material = material();
    warn_of_losses();
    return std::move(mesh_);
  }

 private:
  static Vec3 vec3(const float* v) { return {v[0], v[1], v[2]}; }

  bool has(const std::string& name) const { return from_.attributes.contains(name); }

  // Many primitives may share one accessor: counts are looked at before anything is read.
  void check_counts() const {
    const std::size_t vertices = count_of(document_, from_.attributes.at("POSITION"));
    require_at_most(document_.limits.vertices, vertices, "vertices", document_.file.string());
    if (from_.indices >= 0)
      require_at_most(document_.limits.triangles, count_of(document_, from_.indices) / 3, "triangles",
                      document_.file.string());
  }

  Floats attribute(const std::string& name, std::initializer_list<int> types) const {
    const int index = from_.attributes.at(name);
    const auto& accessors = document_.model.accessors;
    const std::string part = fmt::format("accessors/{}", index);
    const std::size_t accessor = checked(document_, index, accessors.size(), "such accessor", part);
    Floats floats = draco_ && draco_->has(name) ? draco_->floats(name, accessors[accessor].normalized)
                                                : floats_of(document_, index, types);
    if (std::find(types.begin(), types.end(), floats.width) == types.end())  // TINYGLTF_TYPE_VECn is n
      document_.refuse(part_, fmt::format("{} has {} components an element", name, floats.width));
    if (name != "POSITION" && floats.count() != mesh_.positions.size())
      document_.refuse(part_, fmt::format("{} has {} elements", name, floats.count()),
                       fmt::format("{}, as POSITION has", mesh_.positions.size()));
    return floats;
  }

  void read_normals() {
    if (!has("NORMAL")) return;
    const Floats normals = attribute("NORMAL", {TINYGLTF_TYPE_VEC3});
    for (std::size_t v = 0; v < normals.count(); ++v) mesh_.normals.push_back(vec3(normals.at(v)));
  }

  std::vector<Vec2> read_uvs(const std::string& name) const {
    std::vector<Vec2> uvs;
    if (!has(name)) return uvs;
    const Floats floats = attribute(name, {TINYGLTF_TYPE_VEC2});
    for (std::size_t v = 0; v < floats.count(); ++v) uvs.emplace_back(floats.at(v)[0], floats.at(v)[1]);
    return uvs;
  }

  void read_colors() {
    if (!has("COLOR_0")) return;
    const Floats colors = attribute("COLOR_0", {TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4});
    for (std::size_t v = 0; v < colors.count(); ++v) {
      const float* c = colors.at(v);
      mesh_.colors.push_back({c[0], c[1], c[2], colors.width == 4 ? c[3] : 1.0f});
    }
  }

  void read_triangles() {
    Indices indices;
    if (draco_) {
      indices = draco_->indices();
    } else if (from_.indices >= 0) {
      indices = indices_of(document_, from_.indices, mesh_.positions.size());
    } else {
      for (std::size_t v = 0; v < mesh_.positions.size(); ++v)
        indices.push_back(static_cast<std::uint32_t>(v));
    }
    if (!draco_) indices = as_triangles(indices, from_.mode);
    if (indices.size() % 3 != 0)
      document_.refuse(part_, fmt::format("has {} indices", indices.size()), "a multiple of 3");
    for (std::size_t i = 0; i < indices.size(); i += 3)
      mesh_.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  }

  // The material after all of the document's is what a primitive without one gets.
  int material() const {
    const std::size_t all = document_.model.materials.size();
    if (from_.material < 0) return static_cast<int>(all);
    return static_cast<int>(
        checked(document_, from_.material, all, fmt::format("material {}", from_.material), part_));
  }

  void warn_of_losses() const {
    for (const auto& [name, accessor] : from_.attributes) {
      if (name == "TANGENT")
        document_.warn(scene_, "TANGENT is ignored: tangents follow the texture coordinates");
      else if (name.starts_with("TEXCOORD_") && name > "TEXCOORD_1")
        document_.warn(scene_, fmt::format("{} is ignored: there are two sets at most", name));
      else if (name.starts_with("COLOR_") && name != "COLOR_0")
        document_.warn(scene_, fmt::format("{} is ignored: there is one set at most", name));
      else if (name.starts_with("_"))
        document_.warn(scene_, fmt::format("the attribute {} is ignored", name));
    }
    if (!from_.targets.empty())
      document_.warn(scene_, "morph targets are ignored: meshes stay in their base shape");
    document_.warn_of_unknown(scene_, from_.extensions);
  }

  Scene& scene_;
  const Document& document_;
  const tinygltf::Primitive& from_;
  std::string part_;
  std::optional<DracoMesh> draco_;
  Mesh mesh_;
};

// Meshes in the order of the document.
class Meshes {
 public:
  Meshes(Scene& scene, const Document& document) : scene_(scene), document_(document) {}

  std::vector<int> add_all() {
    add_variants();
    std::vector<int> first;
    for (const tinygltf::Mesh& mesh : document_.model.meshes) {
      first.push_back(static_cast<int>(scene_.meshes.size()));
      const std::string part = fmt::format("meshes/{}", first.size() - 1);
      document_.warn_of_unknown(scene_, mesh.extensions);
      for (const tinygltf::Primitive& p : mesh.primitives) add(p, mesh.name, part);
    }
    first.push_back(static_cast<int>(scene_.meshes.size()));
    return first;
  }

 private:
  void add(const tinygltf::Primitive& p, const std::string& name, const std::string& part) {
    if (p.mode < TINYGLTF_MODE_TRIANGLES || p.mode > TINYGLTF_MODE_TRIANGLE_FAN)
      return document_.warn(scene_,
                            fmt::format("mesh '{}': points or lines (mode {}) are left out; triangles, "
                                        "strips and fans (4, 5, 6) are read",
                                        name, p.mode));
    if (!p.attributes.contains("POSITION"))
      return document_.warn(scene_, fmt::format("mesh '{}': a primitive has no POSITION", name));
    Mesh mesh = Primitive(scene_, document_, p, part).read();
    mesh.name = name.empty() ? part : name;
    const std::string file = document_.file.string();
    require_at_most(document_.limits.vertices, vertices_ += mesh.positions.size(), "vertices", file);
    require_at_most(document_.limits.triangles, triangles_ += mesh.triangles.size(), "triangles", file);
    scene_.meshes.push_back(std::move(mesh));
    if (const tinygltf::Value* variants = find(p.extensions, "KHR_materials_variants"))
      choose(*variants, part);
  }

  void add_variants() {
    const tinygltf::Value* extension = find(document_.model.extensions, "KHR_materials_variants");
    const tinygltf::Value* list = extension ? find(*extension, "variants") : nullptr;
    for (int v = 0; list && v < static_cast<int>(list->ArrayLen()); ++v)
      scene_.variants.push_back({text(list->Get(v), "name").value_or(fmt::format("variants/{}", v)), {}});
  }

  // KHR_materials_variants: { "mappings": [{ "material": 2, "variants": [0, 3] }] } of the mesh added last.
  void choose(const tinygltf::Value& extension, const std::string& part) {
    const tinygltf::Value* mappings = find(extension, "mappings");
    for (int m = 0; mappings && m < static_cast<int>(mappings->ArrayLen()); ++m) {
      const tinygltf::Value& mapping = mappings->Get(m);
      const int material = integer(mapping, "material").value_or(-1);
      checked(document_, material, document_.model.materials.size(), fmt::format("material {}", material),
              part);
      const tinygltf::Value* variants = find(mapping, "variants");
      for (int v = 0; variants && v < static_cast<int>(variants->ArrayLen()); ++v) {
        const int index = integer(variants->Get(v)).value_or(-1);
        scene_
            .variants[checked(document_, index, scene_.variants.size(), fmt::format("variant {}", index),
                              part)]
            .choices.push_back({static_cast<int>(scene_.meshes.size()) - 1, material});
      }
    }
  }

  Scene& scene_;
  const Document& document_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
};

}  // namespace

std::vector<int> add_meshes(Scene& scene, const Document& document) {
  return Meshes(scene, document).add_all();
}

}  // namespace tessera::gltf
