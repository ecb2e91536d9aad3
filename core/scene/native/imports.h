// SPDX-License-Identifier: Apache-2.0
// The files that a native scene takes in, and where the things in them stand.
#pragma once

#include <string>
#include <vector>

#include "core/scene/import.h"
#include "core/scene/native/library.h"
#include "core/scene/native/node.h"

namespace tessera {

class Imports {
 public:
  // Both borrowed; outlive this.
  Imports(Scene& scene, ImportBudget& budget) : scene_(scene), budget_(budget) {}

  // Appends the scene of an element of `import`.
  void take_in(const Node&);

  // Appends what is in the file of a mesh, all of it called `name`, but does not place it: returns where it
  // stands in the file.
  std::vector<Instance> take_in_mesh(const std::string& name, const Node&);

  // Makes what an import brought one object, where it says so. Needs the objects of the scene.
  void join(const Library&);

  // Places instances, transformed; as `object` unless it is -1. `where` names them, for messages.
  void place(const std::vector<Instance>&, const Matrix& transform, int object, const Node& where);

 private:
  // How long the scene's lists are.
  struct Ends {
    std::size_t instances, spheres, quads, disks, cameras, lights;
  };
  struct Joined {
    Node node;
    Ends begin, end;  // what the import brought
  };

  Scene read(const Node&);
  Ends ends() const;
  void add(Scene&& part, const Matrix& transform);
  bool moves(int object) const;
  bool moved_by_file(int object) const;
  int moved_object(int object, const Matrix& transform);

  Scene& scene_;
  ImportBudget& budget_;
  std::vector<Joined> joined_;
  std::vector<bool> of_file_;  // by track: a file brought it
};

}  // namespace tessera
