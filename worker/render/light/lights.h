// SPDX-License-Identifier: Apache-2.0
// Everything that emits, as what next-event estimation needs: pick a light, a direction towards it, and the
// density with which that direction would have been picked.
#pragma once

#include <optional>

#include "worker/render/light/environment.h"
#include "worker/render/material.h"

namespace tessera::tracer {

// A way to a light. Radiance is unshadowed; of a delta light it is irradiance on a surface facing it.
struct LightSample {
  Vec3 direction;  // unit, towards the light
  Vec3 target;     // where a shadow ray ends; just before the light's surface
  bool infinite;   // no target: the shadow ray has no end
  bool delta;      // no other strategy can find this direction
  Color radiance{0, 0, 0};
  float pdf = 0;  // per steradian, or a probability if delta; 0: no sample
};

class Lights {
 public:
  // All are borrowed and must outlive this. Tells `geometry` which of its pieces emit. `radius` is
  // the scene's.
  Lights(const Scene& scene, Geometry& geometry, const Materials& materials, float radius);

  bool empty() const { return picks_.size() == 0; }  // nothing to sample; there may still be an environment
  // sample() heeds `pick`: there are several lights, or one of several triangles.
  bool picks() const { return picks_.size() > 1 || !meshes_.empty(); }
  bool surfaces_emit() const { return surfaces_emit_; }
  bool sky_emits() const { return !environment_.black() || !suns_.empty(); }

  // A light seen from p. `pick` chooses the light, `u` the point on it.
  LightSample sample(const Vec3& p, float pick, const Vec2& u) const;

  // Radiance along a ray that was scattered at a surface with density `scattered` (0: a delta or camera ray)
  // and hits nothing, weighted against sample(). Suns without extent cannot be hit.
  Color escaped(const Vec3& direction, float scattered) const;
  // The same for a ray from `p` that hits the emitting surface `s`.
  Color hit(const Vec3& p, const Vec3& direction, const Surface& s, float scattered) const;

 private:
  enum class Kind { point, spot, sun, mesh, sphere, environment };
  struct Light {
    Kind kind;
    std::size_t index;  // in the scene's list of its kind; of mesh: the piece
    int table = -1;     // of mesh: index into meshes_
  };
  struct EmittingMesh {
    Distribution triangles;  // by area
    float area;
  };
  struct Sun {
    Frame frame;    // z: towards the sun
    float versine;  // 1 - cos(half angle)
    Color radiance;
    float probability;  // of being picked
  };

  void add(const Light& light, float power);
  void add_punctual(float radius);
  void add_meshes();
  void add_spheres();
  void balance();
  LightSample sample_mesh(const Light&, const Vec3& p, float pick, const Vec2& u) const;
  LightSample sample_sphere(const Light&, const Vec3& p, const Vec2& u) const;
  LightSample sample_sun(const Light&, const Vec2& u) const;
  LightSample sample_environment(const Vec2& u) const;
  LightSample sample_at(const Vec3& p, const Light&, float pick, const Vec2& u) const;
  LightSample towards(const Vec3& p, const Vec3& at, const Color& intensity) const;
  float mesh_pdf(const Light&, float distance2, float cosine) const;
  float sphere_pdf(const Sphere&, const Vec3& p, float distance2, float cosine) const;

  const Scene* scene_;
  Geometry* geometry_;
  const Materials* materials_;
  EnvironmentLight environment_;
  std::vector<Light> lights_;
  std::vector<float> powers_;
  Distribution picks_;
  std::vector<EmittingMesh> meshes_;
  std::vector<Sun> suns_;    // those with an extent
  std::vector<int> sun_at_;  // parallel to Scene::suns: index into suns_, or -1
  int environment_pick_ = -1;
  bool surfaces_emit_ = false;
};

}  // namespace tessera::tracer
