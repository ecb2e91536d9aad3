// SPDX-License-Identifier: Apache-2.0
// Everything that emits, as what next-event estimation needs: pick a light, a direction towards it, and the
// density with which that direction would have been picked.
//
// Lights that are somewhere (points, spots, emitting triangles, spheres, quads, disks) are picked by a tree
// (light/tree.h); those infinitely far away (suns, a picture around) by their power. Where there are both,
// each side as a whole gets half of the picks: sun and sky reach all of a scene, a lamp only what is near.
//
// Emitting meshes that move are sampled where they are at the ray's time, with the area they have then. Their
// bounds in the tree hold for the whole shutter, so every pick has one probability and hits weigh exactly.
#pragma once

#include "worker/render/light/environment.h"
#include "worker/render/light/points.h"
#include "worker/render/light/tree.h"
#include "worker/render/material.h"
#include "worker/render/wide.h"

namespace tessera::tracer {

// A way to a light. Radiance is unshadowed; of a delta light it is irradiance on a surface facing it.
struct LightSample {
  Vec3 direction;  // unit, towards the light
  Vec3 target;     // where a shadow ray ends; just before the light's surface
  bool infinite;   // no target: the shadow ray has no end
  bool delta;      // no other strategy can find this direction
  Color radiance{0, 0, 0};
  float pdf = 0;  // per steradian, or a probability if it is a point or a sun without extent; 0: no sample
  const LightTraits* traits = nullptr;
};

// Ways to lights, one a lane; fields as above.
struct WideLightSample {
  Wide3 direction, target;
  Mask infinite, delta;
  Wide3 radiance;
  Wide pdf;
  Wide diffuse;  // of the lights' traits
  std::array<const LightTraits*, kLanes> traits;

  void set(int lane, const LightSample& s) {
    direction.set(lane, s.direction);
    target.set(lane, s.target);
    infinite[lane] = s.infinite ? -1 : 0;
    delta[lane] = s.delta ? -1 : 0;
    radiance.set(lane, s.radiance);
    pdf[lane] = s.pdf;
    diffuse[lane] = s.traits->diffuse;
    traits[static_cast<std::size_t>(lane)] = s.traits;
  }
};

// Where a ray was scattered, for the weight of what it finds against sample() there.
struct Vertex {
  Vec3 position, normal;  // the surface point, and its shading normal on either side: those given to sample()
  float pdf = 0;          // density of the ray's direction; 0: a delta or camera ray
};

// Light at the end of a ray, weighted against sample() at the vertex the ray left.
struct Emitted {
  Color radiance{0, 0, 0};
  const LightTraits* traits = nullptr;
};

// How a light that is somewhere is picked: by what it may give to the point (by its power if there are but
// two), by its power, or all alike. The last two are what the first is measured against.
enum class LightChoice : std::uint8_t { tree, power, uniform };

class Lights {
 public:
  // All are borrowed and must outlive this. Tells `geometry` which of its pieces emit. `radius` is
  // the scene's.
  Lights(const Scene& scene, Geometry& geometry, const Materials& materials, float radius,
         LightChoice choice = LightChoice::tree);

  bool empty() const { return near_.empty() && far_.empty(); }  // nothing to sample; a constant sky may shine
  bool picks() const { return near_.size() + far_.size() > 1 || !tables_.empty(); }  // sample() heeds `pick`
  bool surfaces_emit() const { return surfaces_emit_; }
  bool sky_emits() const { return !environment_.black() || !suns_.empty(); }

  // A light seen from p, a point with the shading normal n (either side of it). `pick` chooses the light, `u`
  // the point on it; `time` is a share of the shutter.
  LightSample sample(const Vec3& p, const Vec3& n, float pick, const Vec2& u, float time = 0) const;

  // If all that sample() ever picks is one sun that has an extent: the same for many points at once.
  bool one_sun() const { return near_.empty() && far_.size() == 1 && suns_.size() == 1; }
  WideLightSample sample_one_sun(const Wide2& u) const;  // precondition: one_sun()

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
  enum class Kind : std::uint8_t { point, spot, triangle, mesh, sphere, quad, disk, sun, environment };
  struct Light {
    Kind kind;
    bool found;              // scattered rays may hit it
    std::uint32_t index;     // in the scene's list of its kind; of a surface: the piece
    std::uint32_t part = 0;  // of a surface: triangle or member of the piece; of a mesh: index into tables_
  };
  // An emitting mesh with too many triangles to be lights of their own, in its own space.
  struct Table {
    int mesh;
    Distribution triangles;  // by area
    double area;
    Vec3 low, high;
  };
  struct Sun {
    Frame frame;    // z: towards the sun
    float versine;  // 1 - cos(half angle)
    Color radiance;
    float probability;  // of being picked
    bool camera;        // sees it
    const LightTraits* traits;
  };
  // Where the pick fell: a light, its probability, and what is left of the number that picked it.
  struct Picked {
    const Light* light = nullptr;
    float probability = 0, share = 0;
  };

  void add_punctual(std::vector<LightBounds>& bounds);
  void add_meshes(std::vector<LightBounds>& bounds);
  void add_triangles(std::uint32_t piece, std::vector<LightBounds>& bounds);
  void add_mesh(std::uint32_t piece, std::vector<LightBounds>& bounds);
  std::uint32_t table_of(int mesh);
  void add_shapes(std::vector<LightBounds>& bounds);
  void add_far(float radius);
  static float spread(Kind kind, const LightBounds& b);
  void share_picks(LightChoice choice, const std::vector<LightBounds>& bounds);

  Picked picked(const Vec3& p, const Vec3& n, float pick) const;
  float probability(const Vec3& p, const Vec3& n, std::uint32_t near) const;
  LightSample sample_at(const Vec3& p, const Light&, float share, const Vec2& u, float time) const;
  LightSample sample_surface(const Vec3& p, const Light&, float share, const Vec2& u, float time) const;
  MaybePoint draw(Kind, const Hit& hit, const Vec3& p, const Vec2& u, float time) const;
  LightSample sample_sun(const Light&, const Vec2& u) const;
  LightSample sample_environment(const Vec2& u) const;
  LightSample towards(const Vec3& p, const Vec3& at, const Color& intensity) const;
  float surface_pdf(const Light&, const Vec3& p, float distance2, float cosine, const Surface& s) const;
  Emitted from_environment(const Vertex&, const Vec3& direction) const;
  Emitted from_sun(const Sun&, const Vertex&) const;
  static bool covers(const Sun&, const Vec3& direction);
  const LightTraits& traits(const Light&) const;

  const Scene* scene_;
  Geometry* geometry_;
  const Materials* materials_;
  EnvironmentLight environment_;
  std::vector<Light> near_, far_;
  float near_share_ = 0;     // of the picks
  LightTree tree_;           // of near_, if so chosen
  Distribution near_picks_;  // else
  Distribution far_picks_;
  std::vector<Table> tables_;
  std::vector<int> table_at_;  // parallel to Scene::meshes: index into tables_, or -1
  std::vector<Sun> suns_;      // those with an extent
  std::vector<int> sun_at_;    // parallel to Scene::suns: index into suns_, or -1
  float environment_probability_ = 0;
  bool surfaces_emit_ = false;
};

}  // namespace tessera::tracer
