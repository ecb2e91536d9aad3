// SPDX-License-Identifier: Apache-2.0
// What is known of a path on its way.
#pragma once

#include "worker/render/bvh.h"
#include "worker/render/light/lights.h"

namespace tessera::tracer {

// Where a ray from the surface starts that leaves along `direction`: just off it, on that side.
inline Vec3 leaving(const Surface& s, const Vec3& direction) {
  return offset_origin(s.position, dot(direction, s.ng) >= 0 ? s.ng : -s.ng);
}

// What is left of light after `distance` metres (Beer and Lambert).
inline Color attenuation(const Color& per_metre, float distance) {
  return {std::exp(-per_metre.x * distance), std::exp(-per_metre.y * distance),
          std::exp(-per_metre.z * distance)};
}

// Light that reaches a vertex, as the camera would get it.
struct Contribution {
  Color light;     // with all that the path makes of it
  float sent = 0;  // luminance of what the emitter sent, weighed as in multiple importance sampling
  const LightTraits* traits = nullptr;
};

struct Path {
  Vec3 origin, direction;  // of the ray in flight
  RayTraits ray;
  Vertex left;           // the vertex it comes from; the origin is off its surface
  Color throughput;      // of the path so far
  float radiance_scale;  // of the refractions in throughput, of which roulette must not know
  Color diffuse_share;   // of the last scattering's weight: what its diffuse lobes made
  Color absorption;      // per metre, of what the ray in flight is in
  float width, spread;   // of the ray's cone: diameter at its origin, growth per metre
  Color direct, indirect, emission;
  float sent;  // sum of Contribution::sent
  int vertices;
  Contribution waiting;  // on what the shadow ray says
  Hit hit;
  Surface surface;
  Bsdf bsdf;
  bool alive;
  bool waits;     // a shadow ray is out
  bool rough;     // something before here was no mirror
  bool texture2;  // no diffuse surface was met yet after the first hit
};

}  // namespace tessera::tracer
