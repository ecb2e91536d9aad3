// SPDX-License-Identifier: Apache-2.0
#include "core/scene/native/native.h"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/nearest.h"
#include "core/scene/files.h"
#include "core/scene/import.h"
#include "core/scene/load.h"
#include "core/scene/native/parts.h"
#include "core/scene/schema.h"

namespace tessera {
namespace {

constexpr std::uint64_t kMaxBytes = 256ull << 20;

void drop_lights(Scene& scene) {
  scene.points.clear();
  scene.spots.clear();
  scene.suns.clear();
  scene.environment = {};
}

template <class Map>
std::vector<std::string_view> keys_of(const Map& map) {
  std::vector<std::string_view> keys;
  for (const auto& [key, value] : map) keys.push_back(key);
  return keys;
}

// Reads the parts in the order in which they refer to each other.
class Reader {
 public:
  Reader(const Node& root, ImportBudget& budget) : root_(root), budget_(budget), shelf_(scene_) {}

  Scene read() {
    scene_.name = root_.text("name", std::filesystem::path(root_.file).stem().string());
    const auto meshes = members("meshes");
    if (const auto camera = root_.find("camera")) scene_.cameras.push_back(read_camera(*camera));
    for (const Node& camera : list("cameras")) scene_.cameras.push_back(read_camera(camera));
    for (const Node& node : list("import")) import(node);
    for (const auto& [name, node] : meshes) import_mesh(name, node);
    for (std::size_t m = 0; m < scene_.materials.size(); ++m)
      materials_[scene_.materials[m].name].push_back(m);
    if (const auto materials = root_.find("materials")) read_materials(*materials);
    for (const auto& [name, node] : meshes) finish_mesh(name, node);
    for (const Node& node : list("instances")) place(node);
    for (const auto& [name, instances] : meshes_)
      if (!placed_.contains(name)) add_instances(instances, {});
    for (const Node& node : list("spheres"))
      scene_.spheres.push_back({node.point("center", Vec3(0)), node.number("radius", 1), material_of(node)});
    for (const Node& node : list("lights")) add_light(scene_, node);
    if (const auto node = root_.find("environment")) scene_.environment = read_environment(*node, shelf_);
    return std::move(scene_);
  }

 private:
  std::vector<Node> list(std::string_view key) const {
    const auto node = root_.find(key);
    return node ? node->items() : std::vector<Node>{};
  }

  std::vector<std::pair<std::string, Node>> members(std::string_view key) const {
    const auto node = root_.find(key);
    return node ? node->members() : std::vector<std::pair<std::string, Node>>{};
  }

  Scene read_file_of(const Node& node) {
    const Node file = node.at("file");
    if (budget_.depth == 0) throw InputError(file.where(), "scenes import each other too deeply", "8 levels");
    if (--budget_.files < 0) throw InputError(file.where(), "too many files are imported", "10000 in all");
    --budget_.depth;
    Scene part = import_scene(node.path("file"), budget_, file.where());
    ++budget_.depth;
    return part;
  }

  static Matrix placement(const Node& node) {
    return (node.text("up", "Y") == "Z" ? z_up_to_y_up() : Matrix()) * transform_of(node);
  }

  void import(const Node& node) {
    Scene part = read_file_of(node);
    if (!node.flag("cameras", true)) part.cameras.clear();
    if (!node.flag("lights", true)) drop_lights(part);
    Environment environment = part.environment;
    if (environment.picture >= 0) environment.picture += static_cast<int>(scene_.pictures.size());
    if (environment.picture >= 0 || environment.radiance != Color(0)) scene_.environment = environment;
    append(scene_, std::move(part), placement(node));
  }

  void read_materials(const Node& materials) {
    for (const auto& [name, node] : materials.members()) {
      if (!materials_.contains(name)) add_material(name);
      for (const std::size_t m : materials_[name]) override_material(scene_.materials[m], node, shelf_);
    }
  }

  std::size_t add_material(const std::string& name) {
    scene_.materials.emplace_back().name = name;
    materials_[name].push_back(scene_.materials.size() - 1);
    return scene_.materials.size() - 1;
  }

  // The material that `node` names, or the light grey one.
  int material_of(const Node& node) {
    if (!node.has("material")) return grey();
    const std::string name = node.text("material", {});
    const auto it = materials_.find(name);
    if (it != materials_.end()) return static_cast<int>(it->second.front());
    const auto names = keys_of(materials_);
    throw InputError(node.at("material").where(), unknown("material", name, names), listed(names));
  }

  int grey() {
    if (!grey_) {
      grey_ = static_cast<int>(scene_.materials.size());
      scene_.materials.emplace_back();
    }
    return *grey_;
  }

  // Takes in the file of a mesh that has one, so that `materials` can speak of what is in it.
  void import_mesh(const std::string& name, const Node& node) {
    if (!node.has("file")) return;
    Scene part = read_file_of(node);
    part.cameras.clear();
    drop_lights(part);
    for (Mesh& mesh : part.meshes) mesh.name = name;
    const auto before = static_cast<std::ptrdiff_t>(scene_.instances.size());
    append(scene_, std::move(part), placement(node));
    meshes_[name].assign(scene_.instances.begin() + before, scene_.instances.end());
    scene_.instances.resize(static_cast<std::size_t>(before));
  }

  void finish_mesh(const std::string& name, const Node& node) {
    std::vector<Instance>& instances = meshes_[name];
    if (!node.has("file")) {
      instances.push_back({static_cast<int>(scene_.meshes.size()), transform_of(node)});
      scene_.meshes.push_back(read_mesh(name, node));
      scene_.meshes.back().material = material_of(node);
    } else if (node.has("material")) {
      for (const Instance& i : instances)
        scene_.meshes[static_cast<std::size_t>(i.mesh)].material = material_of(node);
    }
  }

  void place(const Node& node) {
    const std::string name = node.text("mesh", {});
    const auto it = meshes_.find(name);
    if (it == meshes_.end()) {
      const auto names = keys_of(meshes_);
      throw InputError(node.at("mesh").where(), unknown("mesh", name, names), listed(names));
    }
    placed_.insert(name);
    add_instances(it->second, transform_of(node));
  }

  void add_instances(const std::vector<Instance>& instances, const Matrix& transform) {
    for (const Instance& i : instances) scene_.instances.push_back({i.mesh, i.to_world * transform});
  }

  const Node& root_;
  ImportBudget& budget_;
  Scene scene_;
  PictureShelf shelf_;
  std::optional<int> grey_;                                    // what has no material gets this one
  std::map<std::string, std::vector<std::size_t>> materials_;  // by name; several if imported
  std::map<std::string, std::vector<Instance>> meshes_;        // by name: what it stands for
  std::set<std::string> placed_;                               // meshes that an instance names
};

}  // namespace

Scene read_native(const std::filesystem::path& file, ImportBudget& budget, std::string_view where) {
  const std::string name = file.string();
  const Json document = parse_json(read_file(file, kMaxBytes, where), name);
  const Json schema = parse_json(scene_schema(), "scene.schema.json");
  check_schema(document, schema, name);
  const Node root{&document, name, ""};
  return Reader(root, budget).read();
}

}  // namespace tessera
