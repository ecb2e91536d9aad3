// SPDX-License-Identifier: Apache-2.0
#include "worker/render/light/tree.h"

#include <array>
#include <limits>
#include <tuple>

namespace tessera::tracer {
namespace {

constexpr int kBuckets = 12;
// From this depth on clusters are halved by number, so that no trail is longer than 64 bits.
constexpr int kSureDepth = 28;
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
  r.intensity = std::min(a.intensity + b.intensity, std::numeric_limits<float>::max());
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
std::size_t split(std::span<Item> items, int depth) {
  if (depth < kSureDepth) {
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
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (lights[i].intensity > 0)
      items.push_back({lights[i], middle(lights[i]), static_cast<std::uint32_t>(i)});
  if (items.empty()) return;
  nodes_.reserve(2 * items.size() - 1);
  build(items, 0, 0);
}

void LightTree::build(std::span<Item> items, int depth, std::uint64_t trail) {
  const std::size_t at = nodes_.size();
  LightBounds all;
  for (const Item& i : items) all = joined(all, i.bounds);
  const Vec3 half = (all.high - all.low) * 0.5f;
  nodes_.push_back({middle(all), dot(half, half), all.facing.axis, all.facing.cosine,
                    sine_of(all.facing.cosine), all.cos_reach, all.intensity, items[0].light,
                    items.size() == 1, all.two_sided});
  if (items.size() == 1) {
    trails_[items[0].light] = trail;
    return;
  }
  const std::size_t first = split(items, depth);
  build(items.first(first), depth + 1, trail);
  nodes_[at].next = static_cast<std::uint32_t>(nodes_.size());
  build(items.subspan(first), depth + 1, trail | std::uint64_t{1} << depth);
}

float LightTree::importance(const Node& node, const Vec3& p, const Vec3& n) {
  const Vec3 way = p - node.center;
  const float distance2 = dot(way, way);
  constexpr float kLeast2 = 1e-20f;
  if (distance2 <= std::max(node.radius2, kLeast2)) return node.intensity / std::max(node.radius2, kLeast2);
  const Vec3 direction = way * (1.0f / std::sqrt(distance2));
  // Angles: of the cluster's sphere as p sees it, of the way to p against the axis, against its nearest
  // normal, and against that of the nearest point of the sphere.
  const float sin2 = node.radius2 / distance2, cos_size = root(1.0f - sin2), sin_size = std::sqrt(sin2);
  float cos_axis = dot(node.axis, direction);
  if (node.two_sided) cos_axis = std::abs(cos_axis);
  const float cos_normal = cos_less(cos_axis, sine_of(cos_axis), node.cos_facing, node.sin_facing);
  const float cos_out = cos_less(cos_normal, sine_of(cos_normal), cos_size, sin_size);
  if (cos_out <= node.cos_reach) return 0;
  const float cos_n = std::abs(dot(n, direction));
  const float cos_in = cos_less(cos_n, sine_of(cos_n), cos_size, sin_size);
  // A light that shines further back than a right angle is no Lambertian one.
  const float out = node.cos_reach < 0 ? 1.0f : cos_out;
  return node.intensity * out * cos_in / distance2;
}

// How often the first child of an inner node is taken; negative: neither.
float LightTree::first_share(std::size_t node, const Vec3& p, const Vec3& n) const {
  const float first = importance(nodes_[node + 1], p, n),
              second = importance(nodes_[nodes_[node].next], p, n);
  const float sum = first + second;
  if (!(sum > 0)) return -1;
  return sum < std::numeric_limits<float>::infinity() ? first / sum : 0.5f;
}

LightTree::Pick LightTree::pick(const Vec3& p, const Vec3& n, float u) const {
  if (nodes_.empty()) return {};
  float probability = 1;
  std::size_t at = 0;
  while (!nodes_[at].leaf) {
    const float share = first_share(at, p, n);
    if (share < 0) return {};
    const bool first = u < share;
    const float taken = first ? share : 1 - share;
    u = std::min((first ? u : u - share) / taken, kAlmostOne);
    probability *= taken;
    at = first ? at + 1 : nodes_[at].next;
  }
  return {nodes_[at].next, probability, u};
}

float LightTree::probability(const Vec3& p, const Vec3& n, std::uint32_t light) const {
  std::uint64_t trail = trails_[light];
  if (trail == kNowhere) return 0;
  float probability = 1;
  for (std::size_t at = 0; !nodes_[at].leaf; trail >>= 1) {
    const float share = first_share(at, p, n);
    if (share < 0) return 0;
    const bool first = (trail & 1) == 0;
    probability *= first ? share : 1 - share;
    at = first ? at + 1 : nodes_[at].next;
  }
  return probability;
}

}  // namespace tessera::tracer
