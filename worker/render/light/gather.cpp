// SPDX-License-Identifier: Apache-2.0
// The lights of a scene, found and measured.
#include "worker/render/light/lights.h"

#include <limits>

namespace tessera::tracer {
namespace {

// A sun of less than this half angle (radians) is a point: floats do not resolve its disc.
constexpr float kLeastHalfAngle = 5e-5f;
// Beyond so many triangles a mesh is one light.
constexpr std::size_t kMostTriangles = std::size_t{1} << 20;
// Up to so many near lights are picked by power: a tree would cost more than it gains.
constexpr std::size_t kFew = 2;

float versine(float angle) { return 2 * square(std::sin(angle / 2)); }

float usable(float intensity) {
  return intensity > 0 ? std::min(intensity, std::numeric_limits<float>::max()) : 0.0f;
}

void grow(LightBounds& b, const Vec3& p) {
  for (int k = 0; k < 3; ++k) {
    b.low[k] = std::min(b.low[k], p[k]);
    b.high[k] = std::max(b.high[k], p[k]);
  }
}

LightBounds at_point(const Vec3& p, float intensity) {
  return {.low = p, .high = p, .intensity = usable(intensity)};
}

// Of a radiance of 1.
LightBounds of_shape(const Sphere& s) {
  const Vec3 r(s.radius, s.radius, s.radius);
  return {.low = s.center - r, .high = s.center + r, .intensity = kPi * square(s.radius)};
}
LightBounds of_shape(const Quad& q) {
  const Vec3 normal = cross(q.edge_u, q.edge_v);
  LightBounds b{.low = q.corner, .high = q.corner, .intensity = length(normal)};
  if (b.intensity > 0) b.facing = {normal * (1.0f / b.intensity), 1};
  for (const Vec3& edge : {q.edge_u, q.edge_v, q.edge_u + q.edge_v}) grow(b, q.corner + edge);
  return b;
}
LightBounds of_shape(const Disk& d) {
  const Vec3 n = unit(d.normal);
  const Vec3 r = Vec3(sine_of(n.x), sine_of(n.y), sine_of(n.z)) * d.radius;
  return {.low = d.center - r, .high = d.center + r, .facing = {n, 1}, .intensity = kPi * square(d.radius)};
}

}  // namespace

Lights::Lights(const Scene& scene, Geometry& geometry, const Materials& materials, float radius,
               LightChoice choice)
    : scene_(&scene), geometry_(&geometry), materials_(&materials), environment_(scene) {
  std::vector<LightBounds> bounds;
  add_punctual(bounds);
  add_meshes(bounds);
  add_shapes(bounds);
  add_far(radius);
  share_picks(choice, bounds);
}

void Lights::add_punctual(std::vector<LightBounds>& bounds) {
  for (std::uint32_t i = 0; i < scene_->points.size(); ++i) {
    const PointLight& l = scene_->points[i];
    if (is_black(l.intensity)) continue;
    near_.push_back({Kind::point, false, i});
    bounds.push_back(at_point(l.position, luminance(l.intensity)));
  }
  for (std::uint32_t i = 0; i < scene_->spots.size(); ++i) {
    const SpotLight& l = scene_->spots[i];
    if (is_black(l.intensity)) continue;
    near_.push_back({Kind::spot, false, i});
    bounds.push_back(at_point(l.position, luminance(l.intensity)));
    bounds.back().facing = {unit(l.direction), 1};
    bounds.back().cos_reach = std::cos(l.outer_angle);
  }
}

void Lights::add_meshes(std::vector<LightBounds>& bounds) {
  table_at_.assign(scene_->meshes.size(), -1);
  std::size_t room = kMostTriangles;
  for (std::uint32_t i = 0; i < geometry_->meshes(); ++i) {
    const Mesh& mesh = geometry_->mesh(i);
    if (!materials_->emits(mesh.material) || mesh.triangles.empty()) continue;
    surfaces_emit_ = true;
    geometry_->pieces[i].light = static_cast<int>(near_.size());
    if (mesh.triangles.size() <= room) {
      room -= mesh.triangles.size();
      geometry_->pieces[i].light_step = 1;
      add_triangles(i, bounds);
    } else {
      add_mesh(i, bounds);
    }
  }
}

void Lights::add_triangles(std::uint32_t piece, std::vector<LightBounds>& bounds) {
  const Mesh& mesh = geometry_->mesh(piece);
  const bool found = geometry_->pieces[piece].seen_by & bit(RayKind::scattered);
  const bool two_sided = materials_->double_sided(mesh.material);
  const float radiance = luminance(materials_->mean_emission(mesh.material));
  const std::size_t steps = geometry_->steps(piece);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    near_.push_back({Kind::triangle, found, piece, i});
    Triangle t = geometry_->triangle(piece, i);
    const float twice = length(t.normal);
    LightBounds b{
        .low = t.p[0], .high = t.p[0], .two_sided = two_sided, .intensity = usable(0.5f * twice * radiance)};
    if (steps == 1 && twice > 0) b.facing = {t.normal * (1.0f / twice), 1};  // else: anywhere
    for (std::size_t step = 0; step < steps; ++step) {
      if (step > 0) t = geometry_->triangle(piece, i, float(step) / float(steps - 1));
      for (const Vec3& p : t.p) grow(b, p);
    }
    bounds.push_back(b);
  }
}

std::uint32_t Lights::table_of(int mesh) {
  int& at = table_at_[static_cast<std::size_t>(mesh)];
  if (at >= 0) return static_cast<std::uint32_t>(at);
  at = static_cast<int>(tables_.size());
  const Mesh& m = scene_->meshes[static_cast<std::size_t>(mesh)];
  std::vector<float> areas;
  double area = 0;
  LightBounds box{.low = m.positions[m.triangles[0][0]], .high = m.positions[m.triangles[0][0]]};
  for (const auto& corner : m.triangles) {
    const Vec3& a = m.positions[corner[0]];
    areas.push_back(0.5f * length(cross(m.positions[corner[1]] - a, m.positions[corner[2]] - a)));
    area += areas.back();
    for (const std::uint32_t c : corner) grow(box, m.positions[c]);
  }
  tables_.push_back({mesh, Distribution(areas), area, box.low, box.high});
  return static_cast<std::uint32_t>(at);
}

void Lights::add_mesh(std::uint32_t piece, std::vector<LightBounds>& bounds) {
  const Mesh& mesh = geometry_->mesh(piece);
  const std::uint32_t at = table_of(scene_->instances[piece].mesh);
  const Table& table = tables_[at];
  near_.push_back({Kind::mesh, (geometry_->pieces[piece].seen_by & bit(RayKind::scattered)) != 0, piece, at});
  LightBounds b;
  double scale = 0;
  for (std::size_t step = 0; step < geometry_->steps(piece); ++step) {
    const Matrix m = geometry_->step(piece, step);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p = moved({(corner & 1 ? table.high : table.low).x, (corner & 2 ? table.high : table.low).y,
                            (corner & 4 ? table.high : table.low).z},
                           m);
      if (step == 0 && corner == 0) b.low = b.high = p;
      grow(b, p);
    }
    scale = std::max(scale, std::abs(Imath::M44d(m).determinant()));
  }
  // A convex body shows a quarter of its area on average (Cauchy); how stretched this one is is not looked
  // at.
  const float radiance = luminance(materials_->mean_emission(mesh.material));
  b.intensity = usable(static_cast<float>(table.area * std::cbrt(scale * scale) / 4) * radiance);
  bounds.push_back(b);
}

void Lights::add_shapes(std::vector<LightBounds>& bounds) {
  const auto add = [&](Kind kind, std::uint32_t piece, const auto& shapes, std::vector<int>& lights) {
    const bool found = geometry_->pieces[piece].seen_by & bit(RayKind::scattered);
    const std::vector<std::uint32_t>& members = geometry_->members[geometry_->pieces[piece].shapes];
    for (std::uint32_t i = 0; i < members.size(); ++i) {
      const auto& shape = shapes[members[i]];
      if (!materials_->emits(shape.material)) continue;
      surfaces_emit_ = true;
      lights[members[i]] = static_cast<int>(near_.size());
      near_.push_back({kind, found, piece, i});
      LightBounds b = of_shape(shape);
      b.two_sided = materials_->double_sided(shape.material);
      b.intensity = usable(b.intensity * luminance(materials_->mean_emission(shape.material)));
      bounds.push_back(b);
    }
  };
  for (auto i = static_cast<std::uint32_t>(geometry_->meshes()); i < geometry_->pieces.size(); ++i) {
    const Piece::Kind kind = geometry_->pieces[i].kind;
    if (kind == Piece::Kind::spheres) add(Kind::sphere, i, scene_->spheres, geometry_->sphere_lights);
    if (kind == Piece::Kind::quads) add(Kind::quad, i, scene_->quads, geometry_->quad_lights);
    if (kind == Piece::Kind::disks) add(Kind::disk, i, scene_->disks, geometry_->disk_lights);
  }
}

void Lights::add_far(float radius) {
  std::vector<float> powers;
  sun_at_.assign(scene_->suns.size(), -1);
  for (std::uint32_t i = 0; i < scene_->suns.size(); ++i) {
    const DirectionalLight& sun = scene_->suns[i];
    if (is_black(sun.irradiance)) continue;
    const float half = sun.angular_diameter / 2;
    far_.push_back({Kind::sun, half >= kLeastHalfAngle, i});
    powers.push_back(kPi * square(radius) * luminance(sun.irradiance));
    if (half < kLeastHalfAngle) continue;
    sun_at_[i] = static_cast<int>(suns_.size());
    // A disc of radiance L gives the irradiance pi L sin^2 on a surface that faces it.
    suns_.push_back({Frame(unit(-sun.direction)), versine(half),
                     sun.irradiance * (1.0f / (kPi * square(std::sin(half)))), 0, sun.camera, &sun.light});
  }
  if (environment_.sampled()) {
    far_.push_back({Kind::environment, true, 0});
    powers.push_back(4 * kPi * kPi * square(radius) * luminance(environment_.mean()));
  }
  far_picks_ = Distribution(powers);
}

// The power of a light for each W/sr of its intensity.
float Lights::spread(Kind kind, const LightBounds& b) {
  if (kind == Kind::spot) return 2 * kPi * (1 - b.cos_reach);
  if (kind == Kind::point || kind == Kind::sphere || kind == Kind::mesh) return 4 * kPi;
  return b.two_sided ? 2 * kPi : kPi;
}

void Lights::share_picks(LightChoice choice, const std::vector<LightBounds>& bounds) {
  near_share_ = near_.empty() ? 0.0f : far_.empty() ? 1.0f : 0.5f;
  if (choice == LightChoice::tree && near_.size() > kFew) {
    tree_ = LightTree(bounds);
  } else {
    std::vector<float> weights;
    for (std::size_t i = 0; i < near_.size(); ++i)
      weights.push_back(
          choice == LightChoice::uniform ? 1.0f : bounds[i].intensity * spread(near_[i].kind, bounds[i]));
    near_picks_ = Distribution(weights);
  }
  for (std::size_t i = 0; i < far_.size(); ++i) {
    const float probability = (1 - near_share_) * far_picks_.probability(i);
    if (far_[i].kind == Kind::environment)
      environment_probability_ = probability;
    else if (sun_at_[far_[i].index] >= 0)
      suns_[static_cast<std::size_t>(sun_at_[far_[i].index])].probability = probability;
  }
}

}  // namespace tessera::tracer
