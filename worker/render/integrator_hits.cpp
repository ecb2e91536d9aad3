// SPDX-License-Identifier: Apache-2.0
// What rays find: the surfaces at their ends, and what is done there before light is asked for.
#include "worker/render/integrator.h"

namespace tessera::tracer {

void Integrator::ready_scattering(int lane) {
  Path& path = this->path(lane);
  const Materials& materials = scene_.materials();
  const Vec3 direction = paths_.direction.at(lane);
  const bool lambert = materials.lambert(path.surface.material);
  paths_.lambert[lane] = lambert ? -1 : 0;
  if (lambert) {
    const Materials::Lambert l = materials.lambert(scene_.geometry(), path.hit, path.surface, direction);
    paths_.position.set(lane, path.surface.position);
    paths_.side.set(lane, l.ng);
    paths_.normal.set(lane, l.ns);
    paths_.reflectance.set(lane, l.reflectance);
  } else {
    path.bsdf = materials.bsdf(scene_.geometry(), path.hit, path.surface, direction);
    paths_.normal.set(lane, path.bsdf.frame.z);
  }
}

void Integrator::first_hit(const Turn& turn, int lane, SampleBlock& out) {
  const Path& path = this->path(lane);
  ready_scattering(lane);
  guides_.first_hit(paths_, lane, out);
  const int object = scene_.geometry().object(path.hit);
  if (object >= 0 && scene_.scene().objects[static_cast<std::size_t>(object)].catcher)
    return catch_shadow(turn, lane, out);
  if (path.surface.light >= 0)
    add(lane, -1, arriving(lane, scene_.lights().hit({}, paths_.direction.at(lane), path.surface)), out);
  if (scene_.shows_unlit()) show_unlit(lane);
}

void Integrator::next_hits(int bounce, SampleBlock& out) {
  if (!any(paths_.alive)) return;
  if (bounce == settings_.max_bounces && !surfaces_shine()) return last_hits(bounce, out);
  scene_.bvh().intersect(rays_);
  find_surfaces();
  each_lane(paths_.alive, [&](int lane) { arrive(lane, bounce, out); });
}

// What is hit does not matter any more, only whether the sky is seen.
void Integrator::last_hits(int bounce, SampleBlock& out) {
  shadows_.r = rays_.r.ray;
  store(paths_.alive, shadows_.active);
  scene_.bvh().occluded(shadows_);
  each_lane(paths_.alive & ~shadows_.occluded(), [&](int lane) { find_sky(lane, bounce, out); });
}

// All lanes first, and memory asked before it is needed: the lanes wait for it at the same time then. What
// most triangles are in the world is found side by side.
void Integrator::find_surfaces() {
  const Geometry& geometry = scene_.geometry();
  Paths& p = paths_;
  const Mask hits = p.alive & rays_.hit();
  each_lane(hits, [&](int lane) {
    path(lane).hit = rays_.at(lane);
    geometry.prefetch(path(lane).hit);
  });
  each_lane(hits, [&](int lane) { geometry.prefetch_corners(path(lane).hit); });
  p.width += hits ? p.spread * load(rays_.r.ray.tfar) : Wide{};
  Wide3 a{}, b{}, c{};
  Mask found{};
  each_lane(hits, [&](int lane) {
    const Corners* corners = geometry.corners(path(lane).hit);
    if (!corners) return;
    found[lane] = -1;
    a.set(lane, (*corners)[0]);
    b.set(lane, (*corners)[1]);
    c.set(lane, (*corners)[2]);
  });
  const Wide u = load(rays_.r.hit.u), v = load(rays_.r.hit.v);
  p.position = a * (1.0f - u - v) + b * u + c * v;
  const Wide3 ng = unit_or(cross(b - a, c - a), -p.direction);
  each_lane(hits, [&](int lane) {
    Path& path = this->path(lane);
    if (found[lane])
      geometry.surface_at(path.hit, p.position.at(lane), ng.at(lane), path.time, path.surface);
    else
      path.surface = geometry.surface(path.hit, p.origin.at(lane), p.direction.at(lane), rays_.distance(lane),
                                      path.time);
    path.surface.cone = p.width[lane];
  });
}

// At the end of a ray that was scattered at vertex `bounce`: collects emission, and readies the next vertex.
void Integrator::arrive(int lane, int bounce, SampleBlock& out) {
  const Path& path = this->path(lane);
  if (!rays_.hit(lane)) {
    find_sky(lane, bounce, out);
    return end(lane);
  }
  if (const Color absorption = paths_.absorption.at(lane); !is_black(absorption))
    paths_.throughput.set(lane, paths_.throughput.at(lane) * attenuation(absorption, rays_.distance(lane)));
  if (path.surface.light >= 0) {
    const Emitted found = scene_.lights().hit(paths_.left(lane), paths_.direction.at(lane), path.surface);
    add(lane, bounce, arriving(lane, found), out);
  }
  if (scene_.shows_unlit()) show_unlit(lane);
  if (bounce == settings_.max_bounces || !alive(lane)) return;
  ready_scattering(lane);
  if (settings_.regularise > 0 && paths_.rough[lane] && !paths_.is_lambert(lane))
    regularise(this->path(lane).bsdf, settings_.regularise);
  guides_.later_hit(paths_, lane, bounce, out);
}

}  // namespace tessera::tracer
