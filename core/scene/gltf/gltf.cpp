// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/gltf.h"

#include <fmt/format.h>

#include <Imath/ImathQuat.h>

#include "core/error.h"
#include "core/scene/gltf/document.h"
#include "core/scene/gltf/materials.h"
#include "core/scene/import.h"

namespace tessera {
namespace {

using gltf::Document;
using MatrixD = Imath::M44d;

constexpr std::size_t kMaxPlacements = 16'000'000;  // nodes visited; a graph of shared children may multiply

MatrixD local_transform(const tinygltf::Node& node) {
  MatrixD m;
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
    return m;
  }
  MatrixD scale, move;
  if (node.scale.size() == 3) scale.setScale(Imath::V3d(node.scale[0], node.scale[1], node.scale[2]));
  if (node.rotation.size() == 4)
    m = Imath::Quatd(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])
            .normalized()
            .toMatrix44();
  if (node.translation.size() == 3)
    move.setTranslation(Imath::V3d(node.translation[0], node.translation[1], node.translation[2]));
  return scale * m * move;
}

Vec3 vec3_at(const gltf::Floats& floats, std::size_t i) {
  return {floats.values[3 * i], floats.values[3 * i + 1], floats.values[3 * i + 2]};
}

Vec3 looking_direction(const Matrix& m) { return Vec3(-m[2][0], -m[2][1], -m[2][2]).normalized(); }

class Converter {
 public:
  explicit Converter(const Document& document) : document_(document), model_(document.model) {}

  Scene convert() {
    scene_.name = document_.file.stem().string();
    gltf::add_materials(scene_, document_);
    first_mesh_.reserve(model_.meshes.size() + 1);
    for (const tinygltf::Mesh& mesh : model_.meshes) add_mesh(mesh);
    first_mesh_.push_back(static_cast<int>(scene_.meshes.size()));
    on_path_.resize(model_.nodes.size());
    for (const int root : roots()) visit(root, MatrixD());
    warn_of_losses();
    return std::move(scene_);
  }

 private:
  void warn_here(std::string_view what) {
    warn(scene_, fmt::format("{}: {}", document_.file.string(), what));
  }

  std::vector<int> roots() const {
    if (model_.scenes.empty()) {
      std::vector<bool> is_child(model_.nodes.size());
      for (const tinygltf::Node& node : model_.nodes)
        for (const int child : node.children)
          if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
            is_child[static_cast<std::size_t>(child)] = true;
      std::vector<int> all;
      for (std::size_t n = 0; n < is_child.size(); ++n)
        if (!is_child[n]) all.push_back(static_cast<int>(n));
      return all;
    }
    const int scene = std::max(model_.defaultScene, 0);
    if (static_cast<std::size_t>(scene) >= model_.scenes.size())
      document_.refuse("scene", fmt::format("there is no scene {}", scene));
    return model_.scenes[static_cast<std::size_t>(scene)].nodes;
  }

  void add_mesh(const tinygltf::Mesh& mesh) {
    first_mesh_.push_back(static_cast<int>(scene_.meshes.size()));
    const std::string part = fmt::format("meshes/{}", first_mesh_.size() - 1);
    for (const tinygltf::Primitive& p : mesh.primitives) add_primitive(p, mesh.name, part);
  }

  void add_primitive(const tinygltf::Primitive& p, const std::string& name, const std::string& part) {
    if (p.mode != TINYGLTF_MODE_TRIANGLES && p.mode != -1)
      return warn_here(
          fmt::format("mesh '{}': a primitive of mode {} is left out; triangles (4) are read", name, p.mode));
    const auto position = p.attributes.find("POSITION");
    if (position == p.attributes.end())
      return warn_here(fmt::format("mesh '{}': a primitive has no POSITION", name));
    Mesh mesh;
    mesh.name = name.empty() ? part : name;
    const gltf::Floats positions = gltf::floats_of(document_, position->second, {TINYGLTF_TYPE_VEC3});
    for (std::size_t v = 0; v < positions.count(); ++v) mesh.positions.push_back(vec3_at(positions, v));
    if ((vertices_ += positions.count()) > kMaxVertices)
      document_.refuse(part, "there are too many vertices", fmt::format("{} in all", kMaxVertices));
    read_normals(mesh, p, part);
    read_uvs(mesh, p, part);
    read_triangles(mesh, p, part);
    mesh.material = material_of(p, part);
    warn_of_losses(p);
    scene_.meshes.push_back(std::move(mesh));
  }

  void read_normals(Mesh& mesh, const tinygltf::Primitive& p, const std::string& part) {
    const auto it = p.attributes.find("NORMAL");
    if (it == p.attributes.end()) return;
    const gltf::Floats normals = gltf::floats_of(document_, it->second, {TINYGLTF_TYPE_VEC3});
    check_parallel(normals.count(), mesh, part);
    for (std::size_t v = 0; v < normals.count(); ++v) mesh.normals.push_back(vec3_at(normals, v));
  }

  void read_uvs(Mesh& mesh, const tinygltf::Primitive& p, const std::string& part) {
    const auto it = p.attributes.find("TEXCOORD_0");
    if (it == p.attributes.end()) return;
    const gltf::Floats uvs = gltf::floats_of(document_, it->second, {TINYGLTF_TYPE_VEC2});
    check_parallel(uvs.count(), mesh, part);
    for (std::size_t v = 0; v < uvs.count(); ++v)
      mesh.uvs.emplace_back(uvs.values[2 * v], uvs.values[2 * v + 1]);
  }

  void check_parallel(std::size_t count, const Mesh& mesh, const std::string& part) const {
    if (count != mesh.positions.size())
      document_.refuse(part, fmt::format("an attribute has {} elements", count),
                       fmt::format("{}, as POSITION has", mesh.positions.size()));
  }

  void read_triangles(Mesh& mesh, const tinygltf::Primitive& p, const std::string& part) {
    std::vector<std::uint32_t> indices;
    if (p.indices >= 0) {
      indices = gltf::indices_of(document_, p.indices, mesh.positions.size());
    } else {
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        indices.push_back(static_cast<std::uint32_t>(v));
    }
    if (indices.size() % 3 != 0)
      document_.refuse(part, fmt::format("has {} indices", indices.size()), "a multiple of 3");
    for (std::size_t i = 0; i < indices.size(); i += 3)
      mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  }

  int material_of(const tinygltf::Primitive& p, const std::string& part) const {
    if (p.material < 0) return static_cast<int>(model_.materials.size());
    if (static_cast<std::size_t>(p.material) >= model_.materials.size())
      document_.refuse(part, fmt::format("there is no material {}", p.material));
    return p.material;
  }

  void visit(int index, const MatrixD& parent) {
    const std::string part = fmt::format("nodes/{}", index);
    if (index < 0 || static_cast<std::size_t>(index) >= model_.nodes.size())
      document_.refuse(part, "there is no such node");
    if (on_path_[static_cast<std::size_t>(index)])
      document_.refuse(part, "is among its own children", "a tree");
    if (++visited_ > kMaxPlacements || depth_ > kMaxDepth) document_.refuse(part, "there are too many nodes");
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
    const MatrixD world = local_transform(node) * parent;
    place(node, Matrix(world), part);
    on_path_[static_cast<std::size_t>(index)] = true;
    ++depth_;
    for (const int child : node.children) visit(child, world);
    --depth_;
    on_path_[static_cast<std::size_t>(index)] = false;
  }

  void place(const tinygltf::Node& node, const Matrix& world, const std::string& part) {
    if (node.mesh >= 0) {
      if (static_cast<std::size_t>(node.mesh) >= model_.meshes.size())
        document_.refuse(part, fmt::format("there is no mesh {}", node.mesh));
      const auto mesh = static_cast<std::size_t>(node.mesh);
      for (int m = first_mesh_[mesh]; m < first_mesh_[mesh + 1]; ++m) scene_.instances.push_back({m, world});
    }
    if (node.camera >= 0) add_camera(node, world, part);
    if (const auto it = node.extensions.find("KHR_lights_punctual"); it != node.extensions.end())
      add_light(it->second, world, part);
    for (const auto& [name, value] : node.extensions)
      if (name != "KHR_lights_punctual")
        warn_here(fmt::format("the extension {} of a node is ignored", name));
  }

  void add_camera(const tinygltf::Node& node, const Matrix& world, const std::string& part) {
    if (static_cast<std::size_t>(node.camera) >= model_.cameras.size())
      document_.refuse(part, fmt::format("there is no camera {}", node.camera));
    const tinygltf::Camera& from = model_.cameras[static_cast<std::size_t>(node.camera)];
    if (from.type != "perspective") return warn_here(fmt::format("the {} camera is left out", from.type));
    Camera camera;
    camera.name = node.name.empty() ? from.name : node.name;
    camera.to_world = world;
    camera.vertical_fov = static_cast<float>(from.perspective.yfov);
    if (!(camera.vertical_fov > 0 && camera.vertical_fov < 3.1f))
      document_.refuse(fmt::format("cameras/{}", node.camera),
                       fmt::format("yfov is {}", from.perspective.yfov), "radians above 0, below 3.1");
    scene_.cameras.push_back(camera);
  }

  void add_light(const tinygltf::Value& reference, const Matrix& world, const std::string& part) {
    const int index = reference.IsObject() && reference.Has("light") && reference.Get("light").IsNumber()
                          ? reference.Get("light").GetNumberAsInt()
                          : -1;
    if (index < 0 || static_cast<std::size_t>(index) >= model_.lights.size())
      document_.refuse(part, fmt::format("there is no light {}", index));
    const tinygltf::Light& light = model_.lights[static_cast<std::size_t>(index)];
    Color power(static_cast<float>(light.intensity));
    if (light.color.size() == 3)
      for (int c = 0; c < 3; ++c) power[c] *= static_cast<float>(light.color[static_cast<std::size_t>(c)]);
    const Vec3 position = world.translation(), direction = looking_direction(world);
    if (light.range > 0) warn_here("the range of a light is ignored: light reaches everywhere");
    if (light.type == "point")
      scene_.points.push_back({position, power});
    else if (light.type == "directional")
      scene_.suns.push_back({direction, power});
    else if (light.type == "spot")
      scene_.spots.push_back({position, direction, power, static_cast<float>(light.spot.innerConeAngle),
                              static_cast<float>(light.spot.outerConeAngle)});
    else
      warn_here(fmt::format("a light of type '{}' is left out", light.type));
  }

  void warn_of_losses(const tinygltf::Primitive& p) {
    if (p.attributes.contains("COLOR_0")) warn_here("vertex colours (COLOR_0) are ignored");
    if (p.attributes.contains("TANGENT"))
      warn_here("TANGENT is ignored: tangents follow the texture coordinates");
    if (!p.targets.empty()) warn_here("morph targets are ignored: meshes stay in their base shape");
    for (const auto& [name, value] : p.extensions)
      warn_here(fmt::format("the extension {} of a mesh is ignored", name));
  }

  void warn_of_losses() {
    if (!model_.skins.empty()) warn_here("skins are ignored: meshes stay in their bind pose");
    if (!model_.animations.empty()) warn_here("animations are ignored");
  }

  static constexpr int kMaxDepth = 1000;
  static constexpr std::size_t kMaxVertices = std::size_t{1} << 28;  // many primitives may share one accessor

  const Document& document_;
  const tinygltf::Model& model_;
  Scene scene_;
  std::vector<int> first_mesh_;  // of our meshes, by glTF mesh, and the end
  std::vector<bool> on_path_;    // nodes between a root and the one visited
  std::size_t visited_ = 0, vertices_ = 0;
  int depth_ = 0;
};

}  // namespace

Scene read_gltf(const std::filesystem::path& file, std::string_view where) {
  const Document document = gltf::open(file, where);
  return Converter(document).convert();
}

}  // namespace tessera
