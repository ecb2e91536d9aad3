// SPDX-License-Identifier: Apache-2.0
// Picks one of many lights for a point, about in proportion to what it may receive from each: a tree of
// clusters, descended at random by bounds of their light. Conty Estevez and Kulla 2018, "Importance Sampling
// of Many Lights with Adaptive Tree Splitting", without the splitting; its measure of importance, section 4,
// with the clusters' bounding spheres and with the side of the surface left open, so that light from behind
// it is found too. Nodes have eight children, measured side by side.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "worker/render/light/cone.h"

namespace tessera::tracer {

// What is known of a light, or of many together.
struct LightBounds {
  Vec3 low{0, 0, 0}, high{0, 0, 0};  // box of where it is
  Cone facing;                       // its normals
  float cos_reach = 0;               // it shines up to this angle from its normals
  bool two_sided = false;            // against them as well
  float intensity = 0;               // about the most that it sends into any direction, W/sr; finite, >= 0
};

class LightTree {
 public:
  LightTree() = default;
  // Lights without intensity, or more than 1e15 m away from the origin, are never picked. At most 2^31.
  explicit LightTree(std::span<const LightBounds> lights);

  struct Pick {
    std::uint32_t light = 0;
    float probability = 0;  // 0: no light reaches the point
    float share = 0;        // a fresh random number, in [0, 1)
  };
  // For a point p with the unit normal n, either side; u in [0, 1).
  Pick pick(const Vec3& p, const Vec3& n, float u) const;
  // That pick() there yields the light: the same bits.
  float probability(const Vec3& p, const Vec3& n, std::uint32_t light) const;

 private:
  static constexpr int kWide = 8, kBitsALevel = 3;
  using Slots = std::array<float, kWide>;
  // Children side by side; free slots have no intensity.
  struct alignas(32) Node {
    Slots x, y, z, radius2;  // the sphere about a child's box
    Slots axis_x, axis_y, axis_z, cos_facing, sin_facing, cos_reach, intensity, two_sided;
    std::array<std::uint32_t, kWide> next;  // the child's node; of one light: kLeaf and the light
  };
  static constexpr std::uint32_t kLeaf = 1u << 31;
  struct Item;
  struct Group;
  struct Weights {
    Slots of;
    float sum;
  };
  static Weights weights(const Node&, const Vec3& p, const Vec3& n);
  static std::vector<Group> groups(std::span<Item> items, int level);
  static void fill(Node& node, std::size_t slot, const LightBounds& b);
  std::uint32_t build(std::span<Item> items, int level, std::uint64_t trail);

  std::vector<Node> nodes_;            // the root first
  std::vector<std::uint64_t> trails_;  // of each light: from the lowest bits, the slots that lead to it
};

}  // namespace tessera::tracer
