// SPDX-License-Identifier: Apache-2.0
// A single ray through a scene that is ready for packets.
#pragma once

#include <limits>
#include <optional>

#include "worker/render/render_scene.h"

namespace tessera::testing {

inline constexpr float kEndless = std::numeric_limits<float>::infinity();

struct Seen {
  tracer::Hit hit;
  tracer::Surface surface;
  float distance;
};

inline std::optional<Seen> look(const tracer::Geometry& geometry, const tracer::Bvh& bvh, const Vec3& from,
                                const Vec3& direction, const tracer::RayTraits& traits = {}) {
  tracer::Packet packet;
  for (int& active : packet.active) active = 0;
  packet.set(3, from, direction, kEndless, traits);
  bvh.intersect(packet);
  if (!packet.hit(3)) return std::nullopt;
  const tracer::Hit hit = packet.at(3);
  const float distance = packet.distance(3);
  return Seen{hit, geometry.surface(hit, from, direction, distance, traits.time), distance};
}

inline std::optional<Seen> look(const RenderScene& scene, const Vec3& from, const Vec3& direction,
                                const tracer::RayTraits& traits = {}) {
  return look(scene.geometry(), scene.bvh(), from, direction, traits);
}

inline bool blocked(const RenderScene& scene, const Vec3& from, const Vec3& way, float far,
                    const tracer::RayTraits& traits = {.kind = tracer::RayKind::shadow}) {
  tracer::ShadowPacket packet;
  for (int& active : packet.active) active = 0;
  packet.set(5, from, way, far, traits);
  scene.bvh().occluded(packet);
  return packet.occluded(5);
}

}  // namespace tessera::testing
