// SPDX-License-Identifier: Apache-2.0
#include "worker/render/light/lights.h"

#include "worker/render/warp.h"
#include "worker/render/wide_warp.h"

namespace tessera::tracer {
namespace {

constexpr float kBelowOne = 0x1.fffffep-1f;

// KHR_lights_punctual, "Inner and outer cone angles".
float spot_falloff(const SpotLight& spot, float cosine) {
  const float outer = std::cos(spot.outer_angle);
  const float scale = 1.0f / std::max(0.001f, std::cos(spot.inner_angle) - outer);
  return square(std::clamp((cosine - outer) * scale, 0.0f, 1.0f));
}

}  // namespace

LightSample Lights::sample(const Vec3& p, const Vec3& n, float pick, const Vec2& u, float time) const {
  const Picked chosen = picked(p, n, pick);
  if (!(chosen.probability > 0)) return {};
  LightSample s = sample_at(p, *chosen.light, chosen.share, u, time);
  s.pdf *= chosen.probability;
  s.traits = &traits(*chosen.light);
  return s;
}

Lights::Picked Lights::picked(const Vec3& p, const Vec3& n, float pick) const {
  const auto of = [](const std::vector<Light>& lights, const Distribution& picks, float u, float share) {
    const Distribution::Pick d = lights.size() == 1 ? Distribution::Pick{0, u} : picks.pick(u);
    return Picked{&lights[d.index], share * picks.probability(d.index), d.share};
  };
  if (near_.empty()) return of(far_, far_picks_, pick, 1);
  if (pick >= near_share_)
    return of(far_, far_picks_, std::min((pick - near_share_) / (1 - near_share_), kBelowOne),
              1 - near_share_);
  pick = std::min(pick / near_share_, kBelowOne);
  if (near_picks_.size() > 0) return of(near_, near_picks_, pick, near_share_);
  const LightTree::Pick t = tree_.pick(p, n, pick);
  return {&near_[t.light], near_share_ * t.probability, t.share};
}

// Of picking a near light.
float Lights::probability(const Vec3& p, const Vec3& n, std::uint32_t near) const {
  return near_share_ *
         (near_picks_.size() > 0 ? near_picks_.probability(near) : tree_.probability(p, n, near));
}

const LightTraits& Lights::traits(const Light& light) const {
  static const LightTraits plain;
  switch (light.kind) {
    case Kind::point:
      return scene_->points[light.index].light;
    case Kind::spot:
      return scene_->spots[light.index].light;
    case Kind::sun:
      return scene_->suns[light.index].light;
    case Kind::environment:
      return scene_->environment.light;
    default: {
      const int o = geometry_->object({light.index, light.part, 0, 0});
      return o < 0 ? plain : scene_->objects[static_cast<std::size_t>(o)].light;
    }
  }
}

LightSample Lights::sample_at(const Vec3& p, const Light& light, float share, const Vec2& u,
                              float time) const {
  switch (light.kind) {
    case Kind::point: {
      const PointLight& l = scene_->points[light.index];
      return towards(p, l.position, l.intensity);
    }
    case Kind::spot: {
      const SpotLight& l = scene_->spots[light.index];
      LightSample s = towards(p, l.position, l.intensity);
      s.radiance *= spot_falloff(l, -dot(s.direction, unit(l.direction)));
      return s;
    }
    case Kind::sun:
      return sample_sun(light, u);
    case Kind::environment:
      return sample_environment(u);
    default:
      return sample_surface(p, light, share, u, time);
  }
}

LightSample Lights::towards(const Vec3& p, const Vec3& at, const Color& intensity) const {
  const Vec3 way = at - p;
  const float distance2 = dot(way, way);
  if (!(distance2 > 0)) return {};
  return {way * (1.0f / std::sqrt(distance2)), at, false, true, intensity * (1.0f / distance2), 1};
}

LightSample Lights::sample_sun(const Light& light, const Vec2& u) const {
  const DirectionalLight& l = scene_->suns[light.index];
  if (sun_at_[light.index] < 0) return {unit(-l.direction), {}, true, true, l.irradiance, 1};
  const Sun& sun = suns_[static_cast<std::size_t>(sun_at_[light.index])];
  return {sun.frame.to_world(cone(u, sun.versine)),
          {},
          true,
          false,
          sun.radiance,
          1.0f / (2 * kPi * sun.versine)};
}

WideLightSample Lights::sample_one_sun(const Wide2& u) const {
  const Sun& sun = suns_.front();
  const Frame& f = sun.frame;
  const Wide3 local = cone(u, sun.versine);
  const auto along = [&](float x, float y, float z) { return x * local.x + y * local.y + z * local.z; };
  WideLightSample s{
      .direction = {along(f.x.x, f.y.x, f.z.x), along(f.x.y, f.y.y, f.z.y), along(f.x.z, f.y.z, f.z.z)},
      .target = {},
      .infinite = wide(-1),
      .delta = {},
      .radiance = wide(sun.radiance),
      .pdf = wide(1.0f / (2 * kPi * sun.versine)),
      .diffuse = wide(sun.traits->diffuse),
      .traits = {}};
  s.traits.fill(sun.traits);
  return s;
}

LightSample Lights::sample_environment(const Vec2& u) const {
  const EnvironmentLight::Direction d = environment_.sample(u);
  return {d.direction, {}, true, false, environment_.radiance(d.direction), d.pdf};
}

LightSample Lights::sample_surface(const Vec3& p, const Light& light, float share, const Vec2& u,
                                   float time) const {
  Hit hit{light.index, light.part, 0, 0};
  float chance = 1;
  if (light.kind == Kind::mesh) {
    const Distribution& triangles = tables_[light.part].triangles;
    hit.primitive = static_cast<std::uint32_t>(triangles.pick(share).index);
    chance = triangles.probability(hit.primitive);
  }
  const MaybePoint point = draw(light.kind, hit, p, u, time);
  const int material = geometry_->material(hit);
  if (!point || (point->cosine < 0 && !materials_->double_sided(material))) return {};
  hit.u = point->uv.x;
  hit.v = point->uv.y;
  return {point->direction,
          offset_origin(point->position, point->cosine < 0 ? -point->normal : point->normal),
          false,
          !light.found,
          materials_->emission(material, {*geometry_, hit}) * materials_->opacity(*geometry_, hit),
          point->pdf * chance};
}

MaybePoint Lights::draw(Kind kind, const Hit& hit, const Vec3& p, const Vec2& u, float time) const {
  switch (kind) {
    case Kind::sphere:
      return sample_sphere(scene_->spheres[geometry_->shape(hit)], p, u);
    case Kind::quad:
      return sample_quad(scene_->quads[geometry_->shape(hit)], p, u);
    case Kind::disk:
      return sample_disk(scene_->disks[geometry_->shape(hit)], p, u);
    default:
      return sample_triangle(geometry_->triangle(hit.piece, hit.primitive, time), p, u);
  }
}

// The density of sample_surface() for a hit, the pick of the light left out.
float Lights::surface_pdf(const Light& light, const Vec3& p, float distance2, float cosine,
                          const Surface& s) const {
  const Hit hit{light.index, light.part, 0, 0};
  switch (light.kind) {
    case Kind::sphere:
      return sphere_pdf(scene_->spheres[geometry_->shape(hit)], p, distance2, cosine);
    case Kind::quad:
      return quad_pdf(scene_->quads[geometry_->shape(hit)], p, distance2, cosine);
    case Kind::disk:
      return disk_pdf(scene_->disks[geometry_->shape(hit)], distance2, cosine);
    case Kind::mesh:
      return area_pdf(distance2, cosine, s.area) * tables_[light.part].triangles.probability(s.primitive);
    default:
      return area_pdf(distance2, cosine, s.area);
  }
}

Emitted Lights::from_environment(const Vertex& from, const Vec3& direction) const {
  Color radiance = environment_.radiance(direction);
  if (environment_probability_ > 0 && from.pdf > 0)
    radiance *= power_heuristic(from.pdf, environment_probability_ * environment_.pdf(direction));
  return {radiance, &scene_->environment.light};
}

bool Lights::covers(const Sun& sun, const Vec3& direction) {
  // By the chord, for the cosines of nearly equal directions cancel: chord^2 = 2 versine.
  const Vec3 chord = direction - sun.frame.z;
  return dot(chord, chord) <= 2 * sun.versine;
}

Emitted Lights::from_sun(const Sun& sun, const Vertex& from) const {
  const float sampled = sun.probability / (2 * kPi * sun.versine);
  return {sun.radiance * (from.pdf > 0 ? power_heuristic(from.pdf, sampled) : 1.0f), sun.traits};
}

Emitted Lights::hit(const Vertex& from, const Vec3& direction, const Surface& s) const {
  const Light& light = near_[static_cast<std::size_t>(s.light)];
  const LightTraits* traits_of_it = &traits(light);
  const float cosine = -dot(direction, s.ng);
  if (cosine < 0 && !materials_->double_sided(s.material)) return {Color(0, 0, 0), traits_of_it};
  const Color emission = materials_->emission(s.material, s);
  if (!(from.pdf > 0)) return {emission, traits_of_it};
  const Vec3 way = s.position - from.position;
  const float pdf = surface_pdf(light, from.position, dot(way, way), cosine, s) *
                    probability(from.position, from.normal, static_cast<std::uint32_t>(s.light));
  return {emission * power_heuristic(from.pdf, pdf), traits_of_it};
}

}  // namespace tessera::tracer
