// SPDX-License-Identifier: Apache-2.0
// Where paths get their light: lights asked at a vertex, emitters and sky that are hit.
#include "worker/render/catcher.h"
#include "worker/render/integrator.h"
#include "worker/render/warp.h"

namespace tessera::tracer {

void Integrator::sky(int lane, SampleBlock& out) {
  Path& path = paths_[static_cast<std::size_t>(lane)];
  path.alive = false;
  path.emission = backdrop_;
  scene_.lights().backdrop(path.direction,
                           [&](const Emitted& e) { add(path, lane, -1, arriving(path, e), out); });
  guides_.sky(path, lane, out);
}

// The backdrop is seen through the catcher where light comes to it, and black covers it where none comes.
void Integrator::catch_shadow(const Turn& turn, int lane, SampleBlock& out) {
  Path& path = paths_[static_cast<std::size_t>(lane)];
  path.alive = false;
  const auto i = static_cast<std::size_t>(lane);
  const LightWays ways(
      scene_.lights(), path.surface.position, path.bsdf.frame.z, path.ray.time, [&](int pair) {
        return random_pair(turn.keys[i], turn.index, kCatcherSet + static_cast<std::uint32_t>(pair));
      });
  const float light =
      ways.share_let_through(scene_.bvh(), traits(turn, lane, 0, RayKind::shadow),
                             [&](const Vec3& direction) { return leaving(path.surface, direction); });
  guides_.caught(path, lane, 1 - light, out);
  path.direct = backdrop_ * light;
  scene_.lights().backdrop(path.direction, [&](const Emitted& e) { path.direct += e.radiance * light; });
}

// What an unlit surface shows to the camera, also in a mirror. It is the end of the path.
void Integrator::show_unlit(Path& path) const {
  if (!scene_.materials().unlit(path.surface.material)) return;
  if (path.left.pdf == 0)
    path.emission += path.throughput * scene_.materials().shown(scene_.geometry(), path.hit, path.surface);
  path.alive = false;
}

void Integrator::ask_light(Path& path, int lane) {
  const Lights& lights = scene_.lights();
  const auto i = static_cast<std::size_t>(lane);
  const LightSample light = lights.sample(path.surface.position, path.bsdf.frame.z,
                                          lights.picks() ? which_.y[i] : 0, light_point_[i], path.ray.time);
  if (!(light.pdf > 0)) return;
  const BsdfValue scattered = evaluate(path.bsdf, light.direction);
  const float weight = (light.delta ? 1.0f : power_heuristic(light.pdf, scattered.pdf)) / light.pdf;
  const Color f = scattered.diffuse * light.traits->diffuse + scattered.specular * light.traits->specular;
  path.waiting = {path.throughput * f * light.radiance * weight, luminance(light.radiance) * weight,
                  light.traits};
  if (is_black(path.waiting.light)) return;
  path.waits = true;
  const Vec3 origin = leaving(path.surface, light.direction);
  if (light.infinite)
    shadows_.set(lane, origin, light.direction, kFar, path.ray);
  else
    shadows_.set(lane, origin, light.target - origin, 1, path.ray);
  if (!light.infinite && !is_black(path.absorption))
    path.waiting.light *= attenuation(path.absorption, length(light.target - origin));
}

void Integrator::collect_light(int bounce, SampleBlock& out) {
  bool any = false;
  for (const Path& path : paths_) any |= path.waits;
  if (!any) return;
  scene_.bvh().occluded(shadows_);
  for (int lane = 0; lane < kLanes; ++lane) {
    Path& path = paths_[static_cast<std::size_t>(lane)];
    if (path.waits && !shadows_.occluded(lane)) add(path, lane, bounce, path.waiting, out);
    path.waits = false;
  }
}

void Integrator::find_sky(Path& path, int lane, int bounce, SampleBlock& out) const {
  scene_.lights().escaped(path.left, path.direction,
                          [&](const Emitted& e) { add(path, lane, bounce, arriving(path, e), out); });
}

Contribution Integrator::arriving(const Path& path, const Emitted& found) const {
  Color light = path.throughput * found.radiance;
  const LightTraits& t = *found.traits;
  if (path.vertices > 0 && scene_.parts_light())
    light *= path.diffuse_share * t.diffuse + (Color(1, 1, 1) - path.diffuse_share) * t.specular;
  return {light, luminance(found.radiance), found.traits};
}

// To what scattering made of light at vertex `bounce`; -1: to what the camera sees of an emitter.
void Integrator::add(Path& path, int lane, int bounce, Contribution c, SampleBlock& out) const {
  path.sent += c.sent;
  const float most = bounce > 0 ? settings_.clamp_indirect : settings_.clamp_direct;
  if (bounce >= 0 && most > 0)
    if (const float brightest = max_component(c.light); brightest > most) c.light *= most / brightest;
  (bounce < 0 ? path.emission : bounce == 0 ? path.direct : path.indirect) += c.light;
  if (!groups_ || c.traits->group < 0) return;
  const Aov group = light_group_aov(c.traits->group);
  if (!out.has(group)) return;
  for (int k = 0; k < 3; ++k) out.channel(group, k)[static_cast<std::size_t>(lane)] += c.light[k];
}

}  // namespace tessera::tracer
