// SPDX-License-Identifier: Apache-2.0
#include "core/scene/native/library.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/nearest.h"

namespace tessera {
namespace {

template <class Things>
std::vector<std::size_t> to_change(std::map<std::string, std::vector<std::size_t>>& names, Things& things,
                                   const std::string& name) {
  std::vector<std::size_t>& known = names[name];
  if (known.empty()) {
    known.push_back(things.size());
    things.emplace_back().name = name;
  }
  return known;
}

// Levels of mix above what is none; more than kMaxMixDepth where they have no end.
int mix_depth(const Scene& scene, int material, int levels) {
  const Material& m = scene.materials[static_cast<std::size_t>(material)];
  if (m.kind != Material::Kind::mix || levels > kMaxMixDepth) return levels;
  return std::max(mix_depth(scene, m.first, levels + 1), mix_depth(scene, m.second, levels + 1));
}

}  // namespace

void Library::learn_imported() {
  for (std::size_t m = 0; m < scene_.materials.size(); ++m) materials_[scene_.materials[m].name].push_back(m);
  for (std::size_t o = 0; o < scene_.objects.size(); ++o) objects_[scene_.objects[o].name].push_back(o);
}

std::vector<std::size_t> Library::materials_to_change(const std::string& name) {
  return to_change(materials_, scene_.materials, name);
}

std::vector<std::size_t> Library::objects_to_change(const std::string& name) {
  return to_change(objects_, scene_.objects, name);
}

int Library::first(const Names& names, const Node& node, std::string_view key, std::string_view kind) {
  const std::string name = node.text(key, {});
  if (const auto it = names.find(name); it != names.end()) return static_cast<int>(it->second.front());
  std::vector<std::string_view> known;
  for (const auto& [candidate, indices] : names) known.push_back(candidate);
  throw InputError(node.at(key).where(), unknown(kind, name, known), listed(known));
}

int Library::material(const Node& node, std::string_view key) const {
  return first(materials_, node, key, "material");
}

int Library::material_or_grey(const Node& node) {
  if (node.has("material")) return material(node);
  if (!grey_) {
    grey_ = static_cast<int>(scene_.materials.size());
    scene_.materials.emplace_back();
  }
  return *grey_;
}

int Library::object(const Node& node) const {
  return node.has("object") ? first(objects_, node, "object", "object") : -1;
}

int Library::resting_object(const Node& node) const {
  const int index = object(node);
  if (index >= 0 && scene_.objects[static_cast<std::size_t>(index)].track >= 0)
    throw InputError(
        node.at("object").where(),
        fmt::format("'{}' moves, which spheres, quads and disks cannot", node.text("object", {})),
        "an object without keys, or a mesh");
  return index;
}

void give_material(Scene& scene, int object, int material) {
  const auto give = [&](auto& shapes) {
    for (auto& shape : shapes)
      if (shape.object == object) shape.material = material;
  };
  give(scene.spheres);
  give(scene.quads);
  give(scene.disks);
  std::vector<bool> shared(scene.meshes.size());
  for (const Instance& i : scene.instances)
    if (i.object != object) shared[static_cast<std::size_t>(i.mesh)] = true;
  std::map<int, int> copies;
  for (Instance& i : scene.instances) {
    if (i.object != object) continue;
    if (shared[static_cast<std::size_t>(i.mesh)]) {
      const auto [copy, is_new] = copies.try_emplace(i.mesh, static_cast<int>(scene.meshes.size()));
      if (is_new) scene.meshes.push_back(Mesh(scene.meshes[static_cast<std::size_t>(i.mesh)]));
      i.mesh = copy->second;
      shared.resize(scene.meshes.size());
    }
    scene.meshes[static_cast<std::size_t>(i.mesh)].material = material;
  }
}

void require_finite_mixes(const Scene& scene, const std::string& where) {
  for (std::size_t m = 0; m < scene.materials.size(); ++m)
    if (mix_depth(scene, static_cast<int>(m), 0) > kMaxMixDepth)
      throw InputError(where,
                       fmt::format("the mix '{}' has no end, or too many levels", scene.materials[m].name),
                       fmt::format("{} levels of mixes", kMaxMixDepth));
}

}  // namespace tessera
