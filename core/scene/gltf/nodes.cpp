// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/nodes.h"

#include <Imath/ImathQuat.h>
#include <fmt/format.h>

#include <algorithm>

#include "core/scene/gltf/animation.h"
#include "core/scene/gltf/cameras_and_lights.h"
#include "core/scene/gltf/values.h"

namespace tessera::gltf {
namespace {

constexpr std::uint64_t kMaxVisits = 16'000'000;  // of nodes; a graph of shared children may multiply

// Where a node stands. Below one that moves, things stand in its frame and share its track.
struct Place {
  MatrixD world;   // while nothing moves
  MatrixD since;   // the same from the nearest node that moves, if there is one
  int mover = -1;  // index into Nodes::movers_
};

// The transforms that EXT_mesh_gpu_instancing gives, in the frame of the node.
std::vector<MatrixD> instances_of(const Document& document, const tinygltf::Value& extension,
                                  const std::string& part) {
  const tinygltf::Value* attributes = find(extension, "attributes");
  if (!attributes) document.refuse(part, "EXT_mesh_gpu_instancing has no attributes");
  const auto read = [&](const char* name, int type) {
    const auto accessor = integer(*attributes, name);
    if (accessor)
      require_at_most(document.limits.instances, count_of(document, *accessor), "instances",
                      document.file.string());
    return accessor ? floats_of(document, *accessor, {type}) : Floats{};
  };
  const Floats moves = read("TRANSLATION", TINYGLTF_TYPE_VEC3), turns = read("ROTATION", TINYGLTF_TYPE_VEC4),
               scales = read("SCALE", TINYGLTF_TYPE_VEC3);
  const std::size_t count = std::max({moves.count(), turns.count(), scales.count()});
  for (const Floats* list : {&moves, &turns, &scales})
    if (list->count() != 0 && list->count() != count)
      document.refuse(part, fmt::format("instance attributes have {} and {} elements", list->count(), count),
                      "one an instance");
  std::vector<MatrixD> instances(count);
  for (std::size_t i = 0; i < count; ++i) {
    tinygltf::Node node;
    const auto take = [&](const Floats& from) {
      return from.count() == 0 ? std::vector<double>()
                               : std::vector<double>(from.at(i), from.at(i) + from.width);
    };
    node.translation = take(moves), node.rotation = take(turns), node.scale = take(scales);
    instances[i] = rest_transform(node);
  }
  return instances;
}

class Nodes {
 public:
  Nodes(Scene& scene, const Document& document, const std::vector<int>& first_mesh)
      : scene_(scene),
        document_(document),
        nodes_(document.model.nodes),
        first_mesh_(first_mesh),
        animations_(scene, document),
        on_path_(nodes_.size()) {}

  void add_all() {
    for (const int root : roots()) visit(root, {});
    if (!document_.model.skins.empty())
      document_.warn(scene_, "skins are ignored: meshes stay in their bind pose");
  }

 private:
  struct Mover {
    std::vector<int> path;  // from a root to the node
    int track = -1;         // once it is needed
  };

  std::vector<int> roots() const {
    const auto& scenes = document_.model.scenes;
    if (!scenes.empty()) {
      const int scene = std::max(document_.model.defaultScene, 0);
      return scenes[checked(document_, scene, scenes.size(), fmt::format("scene {}", scene), "scene")].nodes;
    }
    std::vector<bool> is_child(nodes_.size());
    for (const tinygltf::Node& node : nodes_)
      for (const int child : node.children)
        if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
          is_child[static_cast<std::size_t>(child)] = true;
    std::vector<int> all;
    for (std::size_t n = 0; n < is_child.size(); ++n)
      if (!is_child[n]) all.push_back(static_cast<int>(n));
    return all;
  }

  void visit(int index, const Place& parent) {
    const std::string part = fmt::format("nodes/{}", index);
    const std::size_t at = checked(document_, index, nodes_.size(), "such node", part);
    if (on_path_[at]) document_.refuse(part, "is among its own children", "a tree");
    require_at_most(kMaxVisits, ++visits_, "nodes", document_.file.string());
    require_at_most(document_.limits.node_depth, path_.size(), "parents above a node",
                    fmt::format("{}#{}", document_.file.string(), part));
    on_path_[at] = true;
    path_.push_back(index);
    const Place place = place_of(index, parent);
    add_contents(nodes_[at], place, part);
    for (const int child : nodes_[at].children) visit(child, place);
    path_.pop_back();
    on_path_[at] = false;
  }

  Place place_of(int index, const Place& parent) {
    const MatrixD local = rest_transform(nodes_[static_cast<std::size_t>(index)]);
    if (!animations_.move(index)) return {local * parent.world, local * parent.since, parent.mover};
    movers_.push_back({path_, -1});
    return {local * parent.world, MatrixD(), static_cast<int>(movers_.size()) - 1};
  }

  void add_contents(const tinygltf::Node& node, const Place& place, const std::string& part) {
    document_.warn_of_unknown(scene_, node.extensions);
    if (node.mesh >= 0) add_mesh(node, place, part);
    if (node.camera >= 0) add_camera(node, place);
    const tinygltf::Value* light = find(node.extensions, "KHR_lights_punctual");
    if (!light) return;
    add_light(scene_, document_, *light, Matrix(place.world), part);
    if (place.mover >= 0)
      document_.warn(scene_,
                     fmt::format("the light of node '{}' moves in the file, but stays at rest", node.name));
  }

  void add_mesh(const tinygltf::Node& node, const Place& place, const std::string& part) {
    const auto& meshes = document_.model.meshes;
    const std::size_t mesh =
        checked(document_, node.mesh, meshes.size(), fmt::format("mesh {}", node.mesh), part);
    if (first_mesh_[mesh] == first_mesh_[mesh + 1]) return;
    const int object = static_cast<int>(scene_.objects.size());
    Object& added = scene_.objects.emplace_back();
    added.name = !node.name.empty() ? node.name : !meshes[mesh].name.empty() ? meshes[mesh].name : part;
    if (place.mover >= 0) added.track = track_of(place.mover);
    const MatrixD& stands = place.mover >= 0 ? place.since : place.world;
    const tinygltf::Value* many = find(node.extensions, "EXT_mesh_gpu_instancing");
    const std::vector<MatrixD> copies =
        many ? instances_of(document_, *many, part) : std::vector<MatrixD>{MatrixD()};
    const auto primitives = static_cast<std::uint64_t>(first_mesh_[mesh + 1] - first_mesh_[mesh]);
    require_at_most(document_.limits.instances, scene_.instances.size() + primitives * copies.size(),
                    "instances", document_.file.string());
    for (const MatrixD& copy : copies)
      for (int m = first_mesh_[mesh]; m < first_mesh_[mesh + 1]; ++m)
        scene_.instances.push_back({m, Matrix(copy * stands), object});
  }

  // A camera that moves has a track of its own, without the scale of the nodes above it.
  void add_camera(const tinygltf::Node& node, const Place& place) {
    Camera camera = camera_of(document_, node);
    if (place.mover < 0)
      camera.to_world = Matrix(place.world);
    else
      camera.track = animations_.add_track(path_, true);
    scene_.cameras.push_back(camera);
  }

  int track_of(int mover) {
    Mover& found = movers_[static_cast<std::size_t>(mover)];
    if (found.track < 0) found.track = animations_.add_track(found.path, false);
    return found.track;
  }

  Scene& scene_;
  const Document& document_;
  const std::vector<tinygltf::Node>& nodes_;
  const std::vector<int>& first_mesh_;
  Animations animations_;
  std::vector<bool> on_path_;  // nodes between a root and the one visited
  std::vector<int> path_;      // the same in order
  std::vector<Mover> movers_;
  std::uint64_t visits_ = 0;
};

}  // namespace

void add_nodes(Scene& scene, const Document& document, const std::vector<int>& first_mesh) {
  Nodes(scene, document, first_mesh).add_all();
}

}  // namespace tessera::gltf
