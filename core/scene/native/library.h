// SPDX-License-Identifier: Apache-2.0
// What a native scene file calls by name: materials, objects and meshes, its own and those it imports.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/native/node.h"

namespace tessera {

class Library {
 public:
  explicit Library(Scene& scene) : scene_(scene) {}  // borrowed; outlives the library

  // Makes known what there is in the scene: call once, after the imports.
  void learn_imported();

  // All of that name, which are imported ones; or a new one.
  std::vector<std::size_t> materials_to_change(const std::string& name);
  std::vector<std::size_t> objects_to_change(const std::string& name);

  // The material that `node.key` names. Throws InputError with the nearest name if there is none.
  int material(const Node& node, std::string_view key = "material") const;
  int material_or_grey(const Node& node);  // a light grey one if the node names none

  // The object that `node.object` names, -1 if it names none. Throws InputError as above; and for things
  // that rest, if the object moves.
  int object(const Node& node) const;
  int resting_object(const Node& node) const;

 private:
  using Names = std::map<std::string, std::vector<std::size_t>>;
  static int first(const Names&, const Node&, std::string_view key, std::string_view kind);

  Scene& scene_;
  Names materials_, objects_;
  std::optional<int> grey_;
};

// Gives everything that is part of the object the material. A mesh that other objects share is copied.
void give_material(Scene&, int object, int material);

// Throws InputError at `where` if a mix contains itself, or is mixed too deeply.
void require_finite_mixes(const Scene&, const std::string& where);

}  // namespace tessera
