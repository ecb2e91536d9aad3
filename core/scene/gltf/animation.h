// SPDX-License-Identifier: Apache-2.0
// How the nodes of a glTF file move (glTF 2.0, section 3.11), and tracks made of it. Only for the files of
// this folder.
#pragma once

#include <Imath/ImathMatrix.h>

#include <array>
#include <optional>
#include <set>

#include "core/scene/gltf/accessor.h"

namespace tessera::gltf {

using MatrixD = Imath::M44d;

// Where a node stands relative to its parent if nothing moves it.
MatrixD rest_transform(const tinygltf::Node& node);

class Animations {
 public:
  // Reads all animations: they play together, the first that moves a property of a node is heard. What cannot
  // be followed is a warning. Both are borrowed.
  Animations(Scene& scene, const Document& document);

  bool move(int node) const { return !movers_[static_cast<std::size_t>(node)].empty(); }

  // Adds the track of the last node of `path`, which leads there from a root: its world matrix, so dense in
  // time that interpolation is off by no more than 1/1000 of the movement. The index in Scene::tracks.
  // `rigid`: without scale.
  int add_track(const std::vector<int>& path, bool rigid);

 private:
  enum class Property { translation, rotation, scale };
  enum class Interpolation { step, linear, cubic };
  struct Channel {
    Property property;
    Interpolation interpolation;
    std::vector<float> times;
    Floats values;  // one a time, three (in-tangent, value, out-tangent) if cubic
  };

  void read(const tinygltf::Animation& animation, const std::string& part);
  std::optional<Channel> read_channel(const tinygltf::Animation&, const tinygltf::AnimationChannel&,
                                      const std::string& part);
  static std::array<double, 4> value_at(const Channel&, double seconds);
  MatrixD transform_at(int node, double seconds) const;
  MatrixD world_at(const std::vector<int>& path, double seconds, bool rigid) const;
  std::set<float> key_times(const std::vector<int>& path) const;

  Scene& scene_;
  const Document& document_;
  std::vector<std::vector<Channel>> movers_;  // by node
  std::size_t poses_ = 0;                     // in all tracks
};

}  // namespace tessera::gltf
