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

// How much of the angle of a bundle of rays, one a sample, the cone of one ray is made: pictures seen by
// reflection may blur that much.
inline constexpr float kConeShare = 0.1f;

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

// What is known of a path on its way that only its own lane reads.
struct Path {
  Hit hit;
  Surface surface;
  Bsdf bsdf;                 // unless the surface is in Paths::lambert
  float time;                // share of the shutter
  bool texture2;             // no diffuse surface was met yet after the first hit
  const LightTraits* asked;  // of the light that the shadow ray goes to
};

// The paths of a block side by side.
struct Paths {
  Mask alive;
  std::array<Path, kLanes> lane;

  // The ray in flight.
  Wide3 origin, direction;
  Wide width, spread;  // of its cone: diameter at its origin, growth per metre
  Wide3 absorption;    // per metre, of what it is in
  // The vertex it comes from, see Vertex; its origin is off that surface.
  Wide3 left_position, left_normal;
  Wide left_pdf;

  // The surface in hand, as seen from where the ray comes.
  Mask lambert;       // scatters by Lambert's law and nothing else
  Wide3 position;     // of these
  Wide3 side;         // of these: geometric normal, on the side from which they are seen
  Wide3 normal;       // of all: shading normal, on that side
  Wide3 reflectance;  // of these

  Wide3 throughput;     // of the path so far
  Wide radiance_scale;  // of the refractions in throughput, of which roulette must not know
  Wide3 diffuse_share;  // of the last scattering's weight: what its diffuse lobes made
  Mask rough;           // something before here was no mirror
  Wide vertices;

  Wide3 direct, indirect, emission;
  Wide sent;  // sum of Contribution::sent

  // What depends on what the shadow ray says, where there is one.
  Mask waits;
  Wide3 waiting_light;
  Wide waiting_sent;

  // As camera rays begin. Their ways and cones are left to whoever makes them.
  void begin() {
    alive = wide(-1);
    lambert = rough = waits = Mask{};
    absorption = diffuse_share = direct = indirect = emission = left_position = left_normal = Wide3{};
    throughput = wide(Vec3(1, 1, 1));
    radiance_scale = wide(1.0f);
    left_pdf = vertices = sent = Wide{};
  }

  Vertex left(int i) const { return {left_position.at(i), left_normal.at(i), left_pdf[i]}; }
  void leave(int i, const Vertex& v) {
    left_position.set(i, v.position);
    left_normal.set(i, v.normal);
    left_pdf[i] = v.pdf;
  }
  bool is_lambert(int i) const { return lambert[i] != 0; }
  Color albedo(int i) const {
    return is_lambert(i) ? reflectance.at(i) : tracer::albedo(lane[static_cast<std::size_t>(i)].bsdf);
  }
  bool has_diffuse(int i) const {
    return is_lambert(i) || tracer::has_diffuse(lane[static_cast<std::size_t>(i)].bsdf);
  }
};

}  // namespace tessera::tracer
