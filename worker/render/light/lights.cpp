// SPDX-License-Identifier: Apache-2.0
#include "worker/render/light/lights.h"

#include "worker/render/warp.h"

namespace tessera::tracer {
namespace {

// A sun of less than this half angle (radians) is a point: floats do not resolve its disc.
constexpr float kLeastHalfAngle = 5e-5f;

float versine(float angle) { return 2 * square(std::sin(angle / 2)); }

// 1 - cos of the half angle under which a sphere is seen from outside.
float sphere_versine(float radius2, float distance2) {
  const float sin2 = radius2 / distance2;
  return sin2 / (1.0f + root(1.0f - sin2));
}

// KHR_lights_punctual, "Inner and outer cone angles".
float spot_falloff(const SpotLight& spot, float cosine) {
  const float outer = std::cos(spot.outer_angle);
  const float scale = 1.0f / std::max(0.001f, std::cos(spot.inner_angle) - outer);
  return square(std::clamp((cosine - outer) * scale, 0.0f, 1.0f));
}

}  // namespace

Lights::Lights(const Scene& scene, Geometry& geometry, const Materials& materials, float radius)
    : scene_(&scene), geometry_(&geometry), materials_(&materials), environment_(scene) {
  add_punctual(radius);
  add_meshes();
  add_spheres();
  if (environment_.sampled()) {
    environment_pick_ = static_cast<int>(lights_.size());
    add({Kind::environment, 0}, 4 * kPi * kPi * square(radius) * luminance(environment_.mean()));
  }
  balance();
  picks_ = Distribution(powers_);
  for (std::size_t i = 0; i < lights_.size(); ++i)
    if (lights_[i].kind == Kind::sun && sun_at_[lights_[i].index] >= 0)
      suns_[static_cast<std::size_t>(sun_at_[lights_[i].index])].probability = picks_.probability(i);
}

void Lights::add(const Light& light, float power) {
  lights_.push_back(light);
  powers_.push_back(power);
}

// Sun and sky reach all of a scene, a lamp only what is near: by power alone a lamp would hardly ever be
// picked where it matters. So, where there are both, each side as a whole gets half of the picks.
void Lights::balance() {
  const auto far = [&](std::size_t i) {
    return lights_[i].kind == Kind::sun || lights_[i].kind == Kind::environment;
  };
  float sums[2] = {0, 0};
  for (std::size_t i = 0; i < lights_.size(); ++i) sums[far(i)] += powers_[i];
  if (!(sums[0] > 0 && sums[1] > 0)) return;
  for (std::size_t i = 0; i < lights_.size(); ++i) powers_[i] /= sums[far(i)];
}

void Lights::add_punctual(float radius) {
  for (std::size_t i = 0; i < scene_->points.size(); ++i)
    if (const Color& c = scene_->points[i].intensity; !is_black(c))
      add({Kind::point, i}, 4 * kPi * luminance(c));
  for (std::size_t i = 0; i < scene_->spots.size(); ++i)
    if (const SpotLight& s = scene_->spots[i]; !is_black(s.intensity))
      add({Kind::spot, i}, 2 * kPi * versine(s.outer_angle) * luminance(s.intensity));
  sun_at_.assign(scene_->suns.size(), -1);
  for (std::size_t i = 0; i < scene_->suns.size(); ++i) {
    const DirectionalLight& sun = scene_->suns[i];
    if (is_black(sun.irradiance)) continue;
    add({Kind::sun, i}, kPi * square(radius) * luminance(sun.irradiance));
    const float half = sun.angular_diameter / 2;
    if (half < kLeastHalfAngle) continue;
    sun_at_[i] = static_cast<int>(suns_.size());
    // A disc of radiance L gives the irradiance pi L sin^2 on a surface that faces it.
    suns_.push_back({Frame(unit(-sun.direction)), versine(half),
                     sun.irradiance * (1.0f / (kPi * square(std::sin(half)))), 0, sun.camera, &sun.light});
  }
}

void Lights::add_meshes() {
  std::vector<float> areas;
  for (std::size_t i = 0; i < geometry_->meshes(); ++i) {
    const Mesh& mesh = geometry_->mesh(std::uint32_t(i));
    if (!materials_->emits(mesh.material) || mesh.triangles.empty()) continue;
    areas.clear();
    double area = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      areas.push_back(0.5f * length(geometry_->triangle(std::uint32_t(i), std::uint32_t(t)).normal));
      area += areas.back();
    }
    if (!(area > 0)) continue;
    const float sides = materials_->double_sided(mesh.material) ? 2.0f : 1.0f;
    surfaces_emit_ = true;
    geometry_->pieces[i].light = static_cast<int>(lights_.size());
    add({Kind::mesh, i, static_cast<int>(meshes_.size())},
        sides * kPi * static_cast<float>(area) * luminance(materials_->mean_emission(mesh.material)));
    meshes_.push_back({Distribution(areas), static_cast<float>(area)});
  }
}

void Lights::add_spheres() {
  for (std::size_t i = 0; i < scene_->spheres.size(); ++i) {
    const Sphere& s = scene_->spheres[i];
    if (!materials_->emits(s.material)) continue;
    surfaces_emit_ = true;
    geometry_->sphere_lights[i] = static_cast<int>(lights_.size());
    add({Kind::sphere, i},
        4 * kPi * kPi * square(s.radius) * luminance(materials_->mean_emission(s.material)));
  }
}

LightSample Lights::sample(const Vec3& p, const Vec3&, float pick, const Vec2& u) const {
  const Distribution::Pick chosen = lights_.size() == 1 ? Distribution::Pick{0, pick} : picks_.pick(pick);
  LightSample s = sample_at(p, lights_[chosen.index], chosen.share, u);
  s.pdf *= picks_.probability(chosen.index);
  s.traits = &traits(lights_[chosen.index]);
  return s;
}

const LightTraits& Lights::traits(const Light& light) const {
  static const LightTraits plain;
  const auto of_object = [&](int object) -> const LightTraits& {
    return object < 0 ? plain : scene_->objects[static_cast<std::size_t>(object)].light;
  };
  switch (light.kind) {
    case Kind::point:
      return scene_->points[light.index].light;
    case Kind::spot:
      return scene_->spots[light.index].light;
    case Kind::sun:
      return scene_->suns[light.index].light;
    case Kind::environment:
      return scene_->environment.light;
    case Kind::mesh:
      return of_object(scene_->instances[light.index].object);
    case Kind::sphere:
      return of_object(scene_->spheres[light.index].object);
  }
  return plain;
}

LightSample Lights::sample_at(const Vec3& p, const Light& light, float pick, const Vec2& u) const {
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
    case Kind::mesh:
      return sample_mesh(light, p, pick, u);
    case Kind::sphere:
      return sample_sphere(light, p, u);
    case Kind::environment:
      return sample_environment(u);
  }
  return {};
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

LightSample Lights::sample_environment(const Vec2& u) const {
  const EnvironmentLight::Direction d = environment_.sample(u);
  return {d.direction, {}, true, false, environment_.radiance(d.direction), d.pdf};
}

LightSample Lights::sample_mesh(const Light& light, const Vec3& p, float pick, const Vec2& u) const {
  const auto piece = static_cast<std::uint32_t>(light.index);
  const EmittingMesh& mesh = meshes_[static_cast<std::size_t>(light.table)];
  const auto primitive = static_cast<std::uint32_t>(mesh.triangles.pick(pick).index);
  const Vec2 uv = triangle(u);
  const Triangle t = geometry_->triangle(piece, primitive);
  const Vec3 at = t.p[0] * (1.0f - uv.x - uv.y) + t.p[1] * uv.x + t.p[2] * uv.y;
  const Vec3 normal = unit(t.normal);
  const Vec3 way = at - p;
  const float distance2 = dot(way, way);
  const Vec3 direction = way * (1.0f / std::sqrt(distance2));
  const float cosine = -dot(direction, normal);
  const int material = geometry_->mesh(piece).material;
  if (!(distance2 > 0) || cosine == 0 || (cosine < 0 && !materials_->double_sided(material))) return {};
  const Vec2 where = geometry_->uv({piece, primitive, uv.x, uv.y});
  const Color emission =
      materials_->solid(material, where) ? materials_->emission(material, where) : Color(0, 0, 0);
  return {direction, offset_origin(at, cosine < 0 ? -normal : normal), false, false,
          emission,  mesh_pdf(light, distance2, std::abs(cosine))};
}

float Lights::mesh_pdf(const Light& light, float distance2, float cosine) const {
  return distance2 / (cosine * meshes_[static_cast<std::size_t>(light.table)].area);
}

LightSample Lights::sample_sphere(const Light& light, const Vec3& p, const Vec2& u) const {
  const Sphere& sphere = scene_->spheres[light.index];
  const Vec3 to_center = sphere.center - p;
  const float distance2 = dot(to_center, to_center), radius2 = square(sphere.radius);
  const bool inside = distance2 <= radius2;
  if (inside && !materials_->double_sided(sphere.material)) return {};
  Vec3 normal;
  if (inside) {
    normal = cone(u, 2.0f);
  } else {
    const Vec3 d = Frame(unit(to_center)).to_world(cone(u, sphere_versine(radius2, distance2)));
    const float middle = dot(to_center, d);
    const Vec3 past = d * middle - to_center;
    normal = unit(past - d * root(radius2 - dot(past, past)));
  }
  const Vec3 at = sphere.center + normal * sphere.radius;
  const Vec3 way = at - p;
  const float away2 = dot(way, way);
  if (!(away2 > 0)) return {};
  const Vec3 direction = way * (1.0f / std::sqrt(away2));
  return {direction,
          offset_origin(at, inside ? -normal : normal),
          false,
          false,
          materials_->emission(sphere.material, sphere_uv(normal)),
          sphere_pdf(sphere, p, away2, std::abs(dot(direction, normal)))};
}

// From outside: uniform in the cone that holds the sphere. From inside: uniform on its area.
float Lights::sphere_pdf(const Sphere& sphere, const Vec3& p, float distance2, float cosine) const {
  const Vec3 to_center = sphere.center - p;
  const float center2 = dot(to_center, to_center), radius2 = square(sphere.radius);
  if (center2 > radius2) return 1.0f / (2 * kPi * sphere_versine(radius2, center2));
  return cosine > 0 ? distance2 / (cosine * 4 * kPi * radius2) : 0.0f;
}

Emitted Lights::from_environment(const Vertex& from, const Vec3& direction) const {
  Color radiance = environment_.radiance(direction);
  if (environment_pick_ >= 0 && from.pdf > 0) {
    const float probability = picks_.probability(static_cast<std::size_t>(environment_pick_));
    radiance *= power_heuristic(from.pdf, probability * environment_.pdf(direction));
  }
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
  const auto pick = static_cast<std::size_t>(s.light);
  const Light& light = lights_[pick];
  const LightTraits* traits_of_it = &traits(light);
  const float cosine = -dot(direction, s.ng);
  if (cosine < 0 && !materials_->double_sided(s.material)) return {Color(0, 0, 0), traits_of_it};
  const Color emission = materials_->emission(s.material, s.uv);
  if (!(from.pdf > 0)) return {emission, traits_of_it};
  const Vec3 way = s.position - from.position;
  const float distance2 = dot(way, way), slant = std::abs(cosine);
  const float pdf = light.kind == Kind::mesh
                        ? mesh_pdf(light, distance2, slant)
                        : sphere_pdf(scene_->spheres[light.index], from.position, distance2, slant);
  return {emission * power_heuristic(from.pdf, pdf * picks_.probability(pick)), traits_of_it};
}

}  // namespace tessera::tracer
