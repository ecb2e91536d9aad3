// SPDX-License-Identifier: Apache-2.0
// Picks one of many lights for a point, about in proportion to what it may receive from each: a binary tree
// of clusters, descended at random by bounds of their light. Conty Estevez and Kulla 2018, "Importance
// Sampling of Many Lights with Adaptive Tree Splitting", without the splitting; its measure of importance,
// section 4, with the clusters' bounding spheres and with the side of the surface left open, so that light
// from behind it is found too.
#pragma once

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
  // Lights without intensity are never picked.
  explicit LightTree(std::span<const LightBounds> lights);

  struct Pick {
    std::uint32_t light = 0;
    float probability = 0;  // 0: no light reaches the point
    float share = 0;        // a fresh random number, in [0, 1)
  };
  // For a point p with the normal n, either side; u in [0, 1).
  Pick pick(const Vec3& p, const Vec3& n, float u) const;
  // That pick() there yields the light: the same bits.
  float probability(const Vec3& p, const Vec3& n, std::uint32_t light) const;

 private:
  struct Node {
    Vec3 center;
    float radius2;  // of the sphere about its box
    Vec3 axis;
    float cos_facing, sin_facing, cos_reach, intensity;
    std::uint32_t next;  // of a leaf: the light; else its second child, the first is the node that follows
    bool leaf, two_sided;
  };
  struct Item;
  static float importance(const Node&, const Vec3& p, const Vec3& n);
  float first_share(std::size_t node, const Vec3& p, const Vec3& n) const;
  void build(std::span<Item> items, int depth, std::uint64_t trail);

  std::vector<Node> nodes_;            // parents before children
  std::vector<std::uint64_t> trails_;  // of each light: from the lowest bit, the children that lead to it
};

}  // namespace tessera::tracer
