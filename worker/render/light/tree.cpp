// SPDX-License-Identifier: Apache-2.0
#include "worker/render/light/tree.h"

#include <limits>
#include <tuple>

namespace tessera::tracer {
namespace {

constexpr int kBuckets = 12;
// From this level on clusters are halved by number, so that no trail is longer than 64 bits.
constexpr int kSureLevel = 9;
constexpr float kTooFar = 1e15f, kMostIntensity = 1e30f;
constexpr std::uint64_t kNowhere = ~std::uint64_t{0};
constexpr float kAlmostOne = 0x1.fffffep-1f;

Vec3 middle(const LightBounds& b) { return (b.low + b.high) * 0.5f; }

LightBounds joined(const LightBounds& a, const LightBounds& b) {
  if (!(a.intensity > 0)) return b;
  if (!(b.intensity > 0)) return a;
  LightBounds r;
  for (int k = 0; k < 3; ++k) {
    r.low[k] = std::min(a.low[k], b.low[k]);
    r.high[k] = std::max(a.high[k], b.high[k]);
  }
  Cone facing = b.facing;
  if (a.two_sided && b.two_sided && dot(a.facing.axis, facing.axis) < 0) facing.axis = -facing.axis;
  r.facing = joined(a.facing, facing);
  r.cos_reach = std::min(a.cos_reach, b.cos_reach);
  r.two_sided = a.two_sided || b.two_sided;
  r.intensity = std::min(a.intensity + b.intensity, kMostIntensity);
  return r;
}

// The cost of a cluster, equation 1 of the paper, its area that of the bounding sphere.
float cost(const LightBounds& b, float stretch) {
  if (!(b.intensity > 0)) return 0;
  const float facing = std::acos(std::clamp(b.facing.cosine, -1.0f, 1.0f));
  const float reach = std::acos(std::clamp(b.cos_reach, -1.0f, 1.0f));
  const float wide = std::min(facing + reach, kPi), sine = std::sin(facing);
  const float solid =
      2 * kPi * (1 - b.facing.cosine) +
      kPi / 2 * (2 * wide * sine - std::cos(facing - 2 * wide) - 2 * facing * sine + b.facing.cosine);
  const Vec3 size = b.high - b.low;
  return b.intensity * (b.two_sided ? 2.0f : 1.0f) * solid * stretch * dot(size, size);
}

}  // namespace

struct LightTree::Item {
  LightBounds bounds;
  Vec3 middle;
  std::uint32_t light;
};

// Items that become one child.
struct LightTree::Group {
  std::span<Item> items;
  LightBounds bounds;
  float cost;

  explicit Group(std::span<Item> of) : items(of) {
    for (const Item& i : of) bounds = joined(bounds, i.bounds);
    cost = tracer::cost(bounds, 1);
  }
};

namespace {

// Where to cut, as the axis and the first bucket of the second part; axis -1: nowhere.
struct Cut {
  int axis = -1, bucket = 0;
  Vec3 low, scale;  // of the middles; buckets a unit
};

template <typename Item>
int bucket(const Cut& cut, int axis, const Item& item) {
  return std::clamp(static_cast<int>((item.middle[axis] - cut.low[axis]) * cut.scale[axis]), 0, kBuckets - 1);
}

// The cheapest of all cuts between buckets; section 4.4 of the paper.
template <typename Item>
Cut best_cut(std::span<const Item> items) {
  Cut best;
  Vec3 low = items[0].middle, high = low;
  for (const Item& i : items)
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], i.middle[k]);
      high[k] = std::max(high[k], i.middle[k]);
    }
  const Vec3 size = high - low;
  best.low = low;
  float least = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (!(size[axis] > 0)) continue;
    best.scale[axis] = kBuckets / size[axis];
    std::array<LightBounds, kBuckets> in{}, after{};
    for (const Item& i : items) {
      LightBounds& b = in[static_cast<std::size_t>(bucket(best, axis, i))];
      b = joined(b, i.bounds);
    }
    for (std::size_t k = kBuckets - 1; k > 0; --k)
      after[k - 1] = k == kBuckets - 1 ? in[k] : joined(in[k], after[k]);
    const float stretch = max_component(Color(size)) / size[axis];
    LightBounds before;
    for (std::size_t k = 0; k + 1 < kBuckets; ++k) {
      before = joined(before, in[k]);
      const float c = cost(before, stretch) + cost(after[k], stretch);
      if (!(before.intensity > 0 && after[k].intensity > 0) || !(c < least)) continue;
      least = c;
      best.axis = axis;
      best.bucket = static_cast<int>(k) + 1;
    }
  }
  return best;
}

// Reorders the items; returns how many are of the first part, neither none nor all.
template <typename Item>
std::size_t split(std::span<Item> items, bool evenly) {
  if (!evenly) {
    const Cut cut = best_cut(std::span<const Item>(items));
    if (cut.axis >= 0) {
      const auto second = std::partition(
          items.begin(), items.end(), [&](const Item& i) { return bucket(cut, cut.axis, i) < cut.bucket; });
      return static_cast<std::size_t>(second - items.begin());
    }
  }
  const auto half = static_cast<std::ptrdiff_t>(items.size() / 2);
  std::nth_element(items.begin(), items.begin() + half, items.end(), [](const Item& a, const Item& b) {
    return std::tie(a.middle.x, a.middle.y, a.middle.z, a.light) <
           std::tie(b.middle.x, b.middle.y, b.middle.z, b.light);
  });
  return static_cast<std::size_t>(half);
}

}  // namespace

LightTree::LightTree(std::span<const LightBounds> lights) : trails_(lights.size(), kNowhere) {
  std::vector<Item> items;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    LightBounds b = lights[i];
    bool near = true;
    for (int k = 0; k < 3; ++k) near = near && std::abs(b.low[k]) < kTooFar && std::abs(b.high[k]) < kTooFar;
    if (!near || !(b.intensity > 0)) continue;
    b.intensity = std::min(b.intensity, kMostIntensity);
    if (!is_finite(Color(b.facing.axis))) b.facing = {};  // of a direction that is none
    items.push_back({b, middle(b), static_cast<std::uint32_t>(i)});
  }
  if (!items.empty()) build(items, 0, 0);
}

// Splits the costliest group until there are as many as a node has slots.
std::vector<LightTree::Group> LightTree::groups(std::span<Item> items, int level) {
  const bool evenly = level >= kSureLevel;
  std::vector<Group> all{Group(items)};
  while (all.size() < kWide) {
    const auto size = [&](const Group& g) {
      if (g.items.size() == 1) return -1.0f;
      return evenly ? static_cast<float>(g.items.size()) : g.cost;
    };
    const auto most = std::max_element(all.begin(), all.end(),
                                       [&](const Group& a, const Group& b) { return size(a) < size(b); });
    if (most->items.size() == 1) break;
    const std::span<Item> of = most->items;
    const std::size_t first = split(of, evenly);
    *most = Group(of.first(first));
    all.emplace_back(of.subspan(first));
  }
  return all;
}

void LightTree::fill(Node& node, std::size_t slot, const LightBounds& b) {
  const Vec3 at = middle(b), half = (b.high - b.low) * 0.5f;
  node.x[slot] = at.x;
  node.y[slot] = at.y;
  node.z[slot] = at.z;
  node.radius2[slot] = dot(half, half);
  node.axis_x[slot] = b.facing.axis.x;
  node.axis_y[slot] = b.facing.axis.y;
  node.axis_z[slot] = b.facing.axis.z;
  node.cos_facing[slot] = b.facing.cosine;
  node.sin_facing[slot] = sine_of(b.facing.cosine);
  node.cos_reach[slot] = b.cos_reach;
  node.intensity[slot] = b.intensity;
  node.two_sided[slot] = b.two_sided ? 1.0f : 0.0f;
}

std::uint32_t LightTree::build(std::span<Item> items, int level, std::uint64_t trail) {
  const auto at = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({});
  const std::vector<Group> children = groups(items, level);
  for (std::size_t slot = 0; slot < children.size(); ++slot) {
    const Group& child = children[slot];
    const std::uint64_t there = trail | std::uint64_t{slot} << (kBitsALevel * level);
    fill(nodes_[at], slot, child.bounds);
    std::uint32_t next;
    if (child.items.size() == 1) {
      trails_[child.items[0].light] = there;
      next = kLeaf | child.items[0].light;
    } else {
      next = build(child.items, level + 1, there);
    }
    nodes_[at].next[slot] = next;
  }
  return at;
}

// The importance of each child. Without a branch: the compiler measures all of them at once.
LightTree::Weights LightTree::weights(const Node& node, const Vec3& p, const Vec3& n) {
  constexpr float kLeast2 = 1e-20f, kMost = 1e37f;
  Weights w;
  for (std::size_t k = 0; k < kWide; ++k) {
    const float x = p.x - node.x[k], y = p.y - node.y[k], z = p.z - node.z[k];
    // From within the cluster's sphere all that it has may be seen, at about its radius.
    const float near2 = std::max(node.radius2[k], kLeast2), far2 = x * x + y * y + z * z;
    const bool within = far2 <= near2;
    const float distance2 = std::max(far2, near2);
    const float scale = 1.0f / std::sqrt(distance2);
    // Angles: of the cluster's sphere as p sees it, of the way to p against the axis, against its nearest
    // normal, and against that of the nearest point of the sphere.
    const float sin2 = std::min(node.radius2[k] / distance2, 1.0f);
    const float cos_size = std::sqrt(1.0f - sin2), sin_size = std::sqrt(sin2);
    const float along = (x * node.axis_x[k] + y * node.axis_y[k] + z * node.axis_z[k]) * scale;
    const float cos_axis = node.two_sided[k] > 0 ? std::abs(along) : along;
    const float cos_normal = cos_less(cos_axis, sine_of(cos_axis), node.cos_facing[k], node.sin_facing[k]);
    const float cos_out = cos_less(cos_normal, sine_of(cos_normal), cos_size, sin_size);
    const float cos_n = std::abs((x * n.x + y * n.y + z * n.z) * scale);
    const float cos_in = cos_less(cos_n, sine_of(cos_n), cos_size, sin_size);
    // A light that shines further back than a right angle is no Lambertian one.
    const float out = cos_out <= node.cos_reach[k] ? 0.0f : node.cos_reach[k] < 0 ? 1.0f : cos_out;
    const float shape = within ? 1.0f : out * cos_in;
    w.of[k] = std::min(node.intensity[k] / distance2 * shape, kMost);
  }
  w.sum = 0;
  for (const float weight : w.of) w.sum += weight;
  return w;
}

LightTree::Pick LightTree::pick(const Vec3& p, const Vec3& n, float u) const {
  if (nodes_.empty()) return {};
  float probability = 1;
  for (std::uint32_t at = 0;;) {
    const Node& node = nodes_[at];
    const Weights w = weights(node, p, n);
    if (!(w.sum > 0)) return {};
    float left = u * w.sum;
    std::size_t slot = kWide;
    for (std::size_t k = 0; k < kWide; ++k) {  // the last that weighs anything, if rounding leaves a rest
      if (!(w.of[k] > 0)) continue;
      if (slot < kWide) left -= w.of[slot];
      slot = k;
      if (left < w.of[k]) break;
    }
    probability *= w.of[slot] / w.sum;
    u = std::clamp(left / w.of[slot], 0.0f, kAlmostOne);
    at = node.next[slot];
    if (at & kLeaf) return {at & ~kLeaf, probability, u};
  }
}

float LightTree::probability(const Vec3& p, const Vec3& n, std::uint32_t light) const {
  std::uint64_t trail = trails_[light];
  if (trail == kNowhere) return 0;
  float probability = 1;
  for (std::uint32_t at = 0; !(at & kLeaf); trail >>= kBitsALevel) {
    const Weights w = weights(nodes_[at], p, n);
    if (!(w.sum > 0)) return 0;
    const std::size_t slot = trail % kWide;
    probability *= w.of[slot] / w.sum;
    at = nodes_[at].next[slot];
  }
  return probability;
}

}  // namespace tessera::tracer
