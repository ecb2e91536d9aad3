// SPDX-License-Identifier: Apache-2.0
#include "core/scene/native/native.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/error.h"
#include "core/nearest.h"
#include "core/scene/files.h"
#include "core/scene/import.h"
#include "core/scene/load.h"
#include "core/scene/native/imports.h"
#include "core/scene/native/library.h"
#include "core/scene/native/parts.h"
#include "core/scene/roots.h"
#include "core/scene/schema.h"

namespace tessera {
namespace {

constexpr std::uint64_t kMaxBytes = 256ull << 20;

template <class Map>
std::vector<std::string_view> keys_of(const Map& map) {
  std::vector<std::string_view> keys;
  for (const auto& [key, value] : map) keys.push_back(key);
  return keys;
}

// Reads the parts in the order in which they refer to each other.
class Reader {
 public:
  Reader(const Node& root, ImportBudget& budget)
      : root_(root),
        shelf_(scene_, budget.limits.roots),
        context_{scene_, shelf_, root.has("light_groups")},
        imports_(scene_, budget),
        library_(scene_),
        tally_(budget.limits) {}

  Scene read() {
    scene_.files = {root_.file};
    scene_.name = root_.text("name", std::filesystem::path(root_.file).stem().string());
    for (const Node& name : list("light_groups")) declare_group(name);
    if (const auto camera = root_.find("camera")) scene_.cameras.push_back(read_camera(context_, *camera));
    for (const Node& camera : list("cameras")) scene_.cameras.push_back(read_camera(context_, camera));
    read_imports();
    library_.learn_imported();
    read_materials();
    read_objects();
    imports_.join(library_);
    read_meshes();
    read_shapes();
    for (const Node& node : list("lights")) add_light(context_, node);
    if (const auto node = root_.find("environment")) scene_.environment = read_environment(context_, *node);
    if (const auto node = root_.find("background")) scene_.background = read_background(*node);
    scene_.frames_per_second = root_.number("frames_per_second", scene_.frames_per_second);
    for (const auto& [name, node] : members("objects")) give_material_to(name, node);
    for (const Node& node : list("variants")) read_variant(node);
    tally_.count(scene_, root_.where());
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

  void declare_group(const Node& name) {
    const std::size_t before = scene_.light_groups.size();
    light_group(scene_, name.json->text(), name.where());
    if (scene_.light_groups.size() == before)
      throw InputError(name.where(), "is empty, or there twice", "names that differ");
  }

  void read_imports() {
    for (const Node& node : list("import")) {
      imports_.take_in(node);
      tally_.count(scene_, node.where());
    }
    for (const auto& [name, node] : members("meshes")) {
      if (!node.has("file")) continue;
      meshes_[name] = imports_.take_in_mesh(name, node);
      tally_.count(scene_, node.where());
    }
  }

  void read_materials() {
    const auto materials = members("materials");
    for (const auto& [name, node] : materials)
      for (const std::size_t m : library_.materials_to_change(name))
        override_material(context_, scene_.materials[m], node);
    for (const auto& [name, node] : materials)
      for (const std::size_t m : library_.materials_to_change(name)) read_mix(scene_.materials[m], node);
    require_finite_mixes(scene_, materials.empty() ? root_.where() : root_.at("materials").where());
    tally_.count(scene_, root_.where());
  }

  void read_mix(Material& m, const Node& node) {
    for (const char* key : {"first", "second"}) {
      int& index = *key == 'f' ? m.first : m.second;
      if (node.has(key)) index = library_.material(node, key);
      if (m.kind == Material::Kind::mix && index < 0)
        throw InputError(node.where(), fmt::format("the key '{}' is missing", key), "two materials to mix");
    }
    if (m.kind != Material::Kind::mix) m.first = m.second = -1;
  }

  void read_objects() {
    for (const auto& [name, node] : members("objects"))
      for (const std::size_t o : library_.objects_to_change(name))
        override_object(context_, scene_.objects[o], node);
  }

  void give_material_to(const std::string& name, const Node& node) {
    if (!node.has("material")) return;
    const int material = library_.material(node);
    for (const std::size_t o : library_.objects_to_change(name))
      give_material(scene_, static_cast<int>(o), material);
  }

  void read_meshes() {
    const auto meshes = members("meshes");
    for (const auto& [name, node] : meshes) finish_mesh(name, node);
    for (const Node& node : list("instances")) place(node);
    for (const auto& [name, node] : meshes)
      if (node.flag("placed", true) && !placed_.contains(name)) imports_.place(meshes_[name], {}, -1, node);
  }

  void finish_mesh(const std::string& name, const Node& node) {
    std::vector<Instance>& instances = meshes_[name];
    const int object = library_.object(node);
    if (!node.has("file")) {
      instances.push_back({static_cast<int>(scene_.meshes.size()), transform_of(node)});
      scene_.meshes.push_back(read_mesh(name, node));
      scene_.meshes.back().material = library_.material_or_grey(node);
    } else if (node.has("material")) {
      for (const Instance& i : instances)
        scene_.meshes[static_cast<std::size_t>(i.mesh)].material = library_.material(node);
    }
    if (object >= 0)
      for (Instance& i : instances) i.object = object;
  }

  void place(const Node& node) {
    const std::string name = node.text("mesh", {});
    const auto it = meshes_.find(name);
    if (it == meshes_.end()) {
      const auto names = keys_of(meshes_);
      throw InputError(node.at("mesh").where(), unknown("mesh", name, names), listed(names));
    }
    placed_.insert(name);
    imports_.place(it->second, transform_of(node), library_.object(node), node);
  }

  void read_shapes() {
    for (const Node& node : list("spheres"))
      scene_.spheres.push_back({node.point("center", Vec3(0)), node.number("radius", 1),
                                library_.material_or_grey(node), library_.resting_object(node)});
    for (const Node& node : list("quads")) read_quad(node);
    for (const Node& node : list("disks"))
      scene_.disks.push_back({node.point("center", Vec3(0)), node.direction("normal"),
                              node.number("radius", 1), library_.material_or_grey(node),
                              library_.resting_object(node)});
  }

  void read_quad(const Node& node) {
    const Quad quad{node.point("corner", Vec3(0)), node.point("edge_u", Vec3(0)),
                    node.point("edge_v", Vec3(0)), library_.material_or_grey(node),
                    library_.resting_object(node)};
    if (!(Imath::V3d(quad.edge_u).cross(Imath::V3d(quad.edge_v)).length() > 0))
      throw InputError(node.where(), "has no area", "edges that are not parallel");
    scene_.quads.push_back(quad);
  }

  void read_variant(const Node& node) {
    std::map<std::string, std::vector<int>, std::less<>> meshes;
    for (std::size_t m = 0; m < scene_.meshes.size(); ++m)
      meshes[scene_.meshes[m].name].push_back(static_cast<int>(m));
    Variant variant{node.text("name", {}), {}};
    for (const Node& choice : node.at("choices").items()) {
      const std::string name = choice.text("mesh", {});
      const auto it = meshes.find(name);
      if (it == meshes.end()) {
        const auto names = keys_of(meshes);
        throw InputError(choice.at("mesh").where(), unknown("mesh", name, names), listed(names));
      }
      for (const int mesh : it->second) variant.choices.push_back({mesh, library_.material(choice)});
    }
    scene_.variants.push_back(std::move(variant));
  }

  const Node& root_;
  Scene scene_;
  PictureShelf shelf_;
  Context context_;
  Imports imports_;
  Library library_;
  Tally tally_;
  std::map<std::string, std::vector<Instance>> meshes_;  // by name: what it stands for
  std::set<std::string> placed_;                         // meshes that an instance names
};

}  // namespace

Scene read_native(const std::filesystem::path& file, ImportBudget& budget, std::string_view where) {
  const std::filesystem::path allowed = within(budget.limits.roots, file, where);
  const std::string name = allowed.string();
  const Json document =
      parse_json(read_file(allowed, std::min(kMaxBytes, budget.limits.file_bytes), where), name);
  const Json schema = parse_json(scene_schema(), "scene.schema.json");
  check_schema(document, schema, name);
  const Node root{&document, name, ""};
  return Reader(root, budget).read();
}

}  // namespace tessera
