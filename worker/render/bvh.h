// SPDX-License-Identifier: Apache-2.0
// Rays against geometry. The only place that knows Embree.
#pragma once

#include <embree3/rtcore.h>

#include <functional>
#include <limits>
#include <memory>

#include "core/sha256.h"
#include "worker/render/geometry.h"
#include "worker/render/wide.h"

namespace tessera::tracer {

inline constexpr float kFar = std::numeric_limits<float>::infinity();  // of a ray without end

// What a ray is besides its way.
struct RayTraits {
  float time = 0;  // share of the shutter, 0 to 1
  RayKind kind = RayKind::camera;
  std::uint32_t seed = 0;  // decides which part of half-transparent surfaces is there for this ray
};

// Rays of one kind side by side.
struct WideRays {
  const Wide3 &origin, &direction;
  const Wide& far;
  const Wide& time;  // as in RayTraits
  RayKind kind;
  const WideInt& seed;  // as in RayTraits
};

// Rays side by side, as Embree takes them. Unset lanes hold anything.
struct alignas(64) Packet {
  RTCRayHit16 r;
  alignas(64) int active[kLanes];  // -1 or 0

  void set(int lane, const Vec3& origin, const Vec3& direction, float far, const RayTraits& traits = {});
  // These lanes, and no other, are active from now on.
  void set(const Mask& lanes, const WideRays&);
  bool hit(int lane) const { return r.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID; }
  Mask hit() const {
    WideInt geometry;
    std::memcpy(&geometry, r.hit.geomID, sizeof geometry);
    return geometry != static_cast<std::int32_t>(RTC_INVALID_GEOMETRY_ID);
  }
  Hit at(int lane) const;
  float distance(int lane) const { return r.ray.tfar[lane]; }
};

struct alignas(64) ShadowPacket {
  RTCRay16 r;
  alignas(64) int active[kLanes];

  void set(int lane, const Vec3& origin, const Vec3& direction, float far, const RayTraits& traits = {});
  void set(const Mask& lanes, const WideRays&);
  bool occluded(int lane) const { return r.tfar[lane] < 0; }
  Mask occluded() const { return load(r.tfar) < 0; }
};

// No lane is active any more.
template <typename P>
void clear(P& packet) {
  for (int& active : packet.active) active = 0;
}

// True if the surface is there at this hit for a ray of this seed (alpha masks have holes). Pure: it is asked
// in any order, any number of times. The hit's u and v are the texture coordinates if it is on a shape.
using Solid = std::function<bool(const Hit&, std::uint32_t seed)>;

// What Embree builds, which takes the most of what it takes to make a scene ready: made of shapes alone, so
// that scenes of other materials, lights and cameras share it.
class BvhCore {
 public:
  // `geometry` is read, not kept. `masked` says on which materials' surfaces hits are to be asked about.
  BvhCore(const Geometry& geometry, const std::function<bool(int material)>& masked);
  ~BvhCore();
  BvhCore(const BvhCore&) = delete;
  BvhCore& operator=(const BvhCore&) = delete;

  struct Contents;
  const Contents& contents() const { return *contents_; }

 private:
  std::unique_ptr<Contents> contents_;
};

// Equal for geometries of which equal cores are built.
Digest core_key(const Geometry& geometry, const std::function<bool(int material)>& masked);

class Bvh {
 public:
  // `geometry` is borrowed and must outlive this; `core` is one of it. `solid` is asked about hits on masked
  // surfaces.
  Bvh(const Geometry& geometry, std::shared_ptr<const BvhCore> core, Solid solid);
  ~Bvh();
  Bvh(const Bvh&) = delete;
  Bvh& operator=(const Bvh&) = delete;

  // Rays that start side by side and go nearly the same way.
  void intersect_coherent(Packet&) const;
  void intersect(Packet&) const;
  // Never declared coherent: Embree 3.13 then loops for ever where instances are, and is no faster elsewhere.
  void occluded(ShadowPacket&) const;

  struct Bounds {
    Vec3 low, high;  // of everything; both 0 for an empty scene
  };
  Bounds bounds() const;

 private:
  std::shared_ptr<const BvhCore> core_;
  const Geometry& geometry_;
  Solid solid_;
};

inline void Packet::set(int lane, const Vec3& origin, const Vec3& direction, float far,
                        const RayTraits& traits) {
  r.ray.org_x[lane] = origin.x;
  r.ray.org_y[lane] = origin.y;
  r.ray.org_z[lane] = origin.z;
  r.ray.tnear[lane] = 0;
  r.ray.dir_x[lane] = direction.x;
  r.ray.dir_y[lane] = direction.y;
  r.ray.dir_z[lane] = direction.z;
  r.ray.time[lane] = traits.time;
  r.ray.tfar[lane] = far;
  r.ray.mask[lane] = bit(traits.kind);
  r.ray.id[lane] = traits.seed;
  r.ray.flags[lane] = 0;
  r.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  r.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  active[lane] = -1;
}

inline void set_rays(RTCRay16& r, const WideRays& rays) {
  store(rays.origin.x, r.org_x);
  store(rays.origin.y, r.org_y);
  store(rays.origin.z, r.org_z);
  store(Wide{}, r.tnear);
  store(rays.direction.x, r.dir_x);
  store(rays.direction.y, r.dir_y);
  store(rays.direction.z, r.dir_z);
  store(rays.time, r.time);
  store(rays.far, r.tfar);
  store(wide(std::int32_t{bit(rays.kind)}), r.mask);
  store(rays.seed, r.id);
  store(WideInt{}, r.flags);
}

inline void Packet::set(const Mask& lanes, const WideRays& rays) {
  set_rays(r.ray, rays);
  const WideInt none = wide(static_cast<std::int32_t>(RTC_INVALID_GEOMETRY_ID));
  store(none, r.hit.geomID);
  store(none, r.hit.instID[0]);
  store(lanes, active);
}

inline void ShadowPacket::set(const Mask& lanes, const WideRays& rays) {
  set_rays(r, rays);
  store(lanes, active);
}

inline Hit Packet::at(int lane) const {
  const unsigned instance = r.hit.instID[0][lane];
  return {instance != RTC_INVALID_GEOMETRY_ID ? instance : r.hit.geomID[lane], r.hit.primID[lane],
          r.hit.u[lane], r.hit.v[lane]};
}

inline void ShadowPacket::set(int lane, const Vec3& origin, const Vec3& direction, float far,
                              const RayTraits& traits) {
  r.org_x[lane] = origin.x;
  r.org_y[lane] = origin.y;
  r.org_z[lane] = origin.z;
  r.tnear[lane] = 0;
  r.dir_x[lane] = direction.x;
  r.dir_y[lane] = direction.y;
  r.dir_z[lane] = direction.z;
  r.time[lane] = traits.time;
  r.tfar[lane] = far;
  r.mask[lane] = bit(traits.kind);
  r.id[lane] = traits.seed;
  r.flags[lane] = 0;
  active[lane] = -1;
}

}  // namespace tessera::tracer
