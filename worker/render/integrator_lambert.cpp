// SPDX-License-Identifier: Apache-2.0
// Paths at surfaces that scatter by Lambert's law and nothing else, all lanes of a block at once. What is
// done is what Integrator::scatter() does with a Bsdf of one Lambert lobe.
#include "worker/render/integrator.h"
#include "worker/render/wide_warp.h"

namespace tessera::tracer {
namespace {

// Which directions are on the side from which the surface is seen, for both normals; `cosine` is to the
// shading normal.
Mask scatters_to(const Paths& p, const Wide3& direction, const Wide& cosine) {
  return (dot(p.direction, p.normal) < 0) & (cosine > 0) & (dot(direction, p.side) > 0);
}

}  // namespace

void Integrator::scatter_lambert(const Turn& turn, int bounce, SampleBlock& out) {
  Paths& p = paths_;
  const Mask here = p.alive & p.lambert;
  p.alive &= ~here;
  store(Mask{}, rays_.active);
  store(Mask{}, shadows_.active);
  if (!any(here)) return;
  p.vertices += here ? wide(1.0f) : Wide{};
  if (!scene_.lights().empty()) ask_lights_lambert(turn, here, bounce);
  if (bounce == settings_.max_bounces && !scene_.lights().sky_emits() && !surfaces_shine()) return;
  const Wide3 local = cosine_hemisphere(direction_.all());
  const Wide3 wi = WideFrame(p.normal).to_world(local);
  Mask goes_on = here & scatters_to(p, wi, local.z) & ~is_black(p.reflectance);
  p.throughput = chosen(goes_on, p.throughput * p.reflectance, p.throughput);
  p.diffuse_share = chosen(goes_on, wide(Vec3(1, 1, 1)), p.diffuse_share);
  p.rough |= goes_on;
  const Wide pdf = local.z * kInvPi;
  p.spread += goes_on ? kConeShare / root(pdf) : Wide{};
  p.left_position = chosen(goes_on, p.position, p.left_position);
  p.left_normal = chosen(goes_on, p.normal, p.left_normal);
  p.left_pdf = goes_on ? pdf : p.left_pdf;
  p.direction = chosen(goes_on, wi, p.direction);
  p.origin = chosen(goes_on, offset_origin(p.position, p.side), p.origin);
  if (bounce == 0 && guides_.takes_bounces(out))
    each_lane(goes_on, [&](int lane) { guides_.first_bounce(p, lane, out); });
  goes_on = survive(goes_on, bounce);
  p.alive |= goes_on;
  rays_.set(goes_on, {p.origin, p.direction, wide(kFar), rays_time_, RayKind::scattered,
                      seeds(turn, goes_on, bounce, RayKind::scattered)});
}

// survives() of these lanes.
Mask Integrator::survive(const Mask& here, int bounce) {
  if (bounce < settings_.sure_bounces || bounce == settings_.max_bounces) return here;
  const Wide chance = smaller(root(max_component(paths_.throughput) / paths_.radiance_scale), wide(1.0f));
  const Mask lives = here & (load(roulette_.x.data()) < chance);
  paths_.throughput = chosen(lives, paths_.throughput * (1.0f / chance), paths_.throughput);
  return lives;
}

WideLightSample Integrator::lights_seen(const Mask& from) const {
  const Lights& lights = scene_.lights();
  if (lights.one_sun()) return lights.sample_one_sun(light_point_.all());
  WideLightSample all{};
  each_lane(from, [&](int lane) {
    const auto i = static_cast<std::size_t>(lane);
    const LightSample s =
        lights.sample(paths_.position.at(lane), paths_.normal.at(lane), lights.picks() ? which_.y[i] : 0,
                      light_point_[i], paths_.lane[i].time);
    if (s.pdf > 0) all.set(lane, s);
  });
  return all;
}

void Integrator::ask_lights_lambert(const Turn& turn, const Mask& here, int bounce) {
  Paths& p = paths_;
  const WideLightSample light = lights_seen(here);
  const Wide cosine = dot(light.direction, p.normal), pdf = cosine * kInvPi;
  const Wide weight = (light.delta ? wide(1.0f) : power_heuristic(light.pdf, pdf)) / light.pdf;
  const Wide3 f = p.reflectance * (pdf * light.diffuse * weight);
  p.waiting_light = p.throughput * f * light.radiance;
  p.waiting_sent = luminance(light.radiance) * weight;
  p.waits = here & (light.pdf > 0) & scatters_to(p, light.direction, cosine) & ~is_black(p.waiting_light);
  if (!any(p.waits)) return;
  const Wide3 origin = offset_origin(p.position, p.side);
  const Wide3 way = chosen(light.infinite, light.direction, light.target - origin);
  const Wide far = light.infinite ? wide(kFar) : wide(1.0f);
  shadows_.set(p.waits, {origin, way, far, rays_time_, RayKind::shadow,
                         seeds(turn, p.waits, bounce, RayKind::shadow)});
  each_lane(p.waits & ~light.infinite & ~is_black(p.absorption), [&](int lane) {
    const Color left = attenuation(p.absorption.at(lane), length(way.at(lane)));
    p.waiting_light.set(lane, p.waiting_light.at(lane) * left);
  });
  if (groups_)
    each_lane(p.waits, [&](int lane) { path(lane).asked = light.traits[static_cast<std::size_t>(lane)]; });
}

}  // namespace tessera::tracer
