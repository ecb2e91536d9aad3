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
  const LightTraits* traits = nullptr;
};

// Where a ray was scattered, for the weight of what it finds against sample() there.
struct Vertex {
  Vec3 position, normal;  // the surface point, and its shading normal on the side the path came from
  float pdf = 0;          // density of the ray's direction; 0: a delta or camera ray
};

// Light at the end of a ray, weighted against sample() at the vertex the ray left.
struct Emitted {
  Color radiance{0, 0, 0};
  const LightTraits* traits = nullptr;
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

  // A light seen from p, a point with the shading normal n. `pick` chooses the light, `u` the point on it.
  LightSample sample(const Vec3& p, const Vec3& n, float pick, const Vec2& u, float time = 0) const;

  // What a scattered ray finds that hits nothing: calls collect(Emitted) for the environment and for each sun
  // in that direction. Suns without extent cannot be hit.
  template <typename Collect>
  void escaped(const Vertex& from, const Vec3& direction, const Collect& collect) const {
    if (!environment_.black()) collect(from_environment(from, direction));
    for (const Sun& sun : suns_)
      if (covers(sun, direction)) collect(from_sun(sun, from));
  }
  // The same for a camera ray: what stands behind everything is the scene's background.
  template <typename Collect>
  void backdrop(const Vec3& direction, const Collect& collect) const {
    if (scene_->background.kind == Background::Kind::environment && !environment_.black())
      collect(from_environment({}, direction));
    for (const Sun& sun : suns_)
      if (sun.camera && covers(sun, direction)) collect(from_sun(sun, {}));
  }
  // The same for a ray that hits the emitting surface `s`.
  Emitted hit(const Vertex& from, const Vec3& direction, const Surface& s) const;

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
    bool camera;        // sees it
    const LightTraits* traits;
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
  Emitted from_environment(const Vertex&, const Vec3& direction) const;
  Emitted from_sun(const Sun&, const Vertex&) const;
  static bool covers(const Sun&, const Vec3& direction);
  const LightTraits& traits(const Light&) const;
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
