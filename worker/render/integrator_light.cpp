// SPDX-License-Identifier: Apache-2.0
// Where paths get their light: lights asked at a vertex, emitters and sky that are hit.
#include "worker/render/catcher.h"
#include "worker/render/integrator.h"
#include "worker/render/warp.h"

namespace tessera::tracer {

void Integrator::sky(int lane, SampleBlock& out) {
  end(lane);
  paths_.emission.set(lane, backdrop_);
  scene_.lights().backdrop(paths_.direction.at(lane),
                           [&](const Emitted& e) { add(lane, -1, arriving(lane, e), out); });
  guides_.sky(paths_, lane, out);
}

// The backdrop is seen through the catcher where light comes to it, and black covers it where none comes.
void Integrator::catch_shadow(const Turn& turn, int lane, SampleBlock& out) {
  const Path& path = this->path(lane);
  end(lane);
  const auto i = static_cast<std::size_t>(lane);
  const LightWays ways(
      scene_.lights(), path.surface.position, paths_.normal.at(lane), path.time, [&](int pair) {
        return random_pair(turn.keys[i], turn.index, kCatcherSet + static_cast<std::uint32_t>(pair));
      });
  const float light =
      ways.share_let_through(scene_.bvh(), traits(turn, lane, 0, RayKind::shadow),
                             [&](const Vec3& direction) { return leaving(path.surface, direction); });
  guides_.caught(paths_, lane, 1 - light, out);
  Color seen = backdrop_ * light;
  scene_.lights().backdrop(paths_.direction.at(lane), [&](const Emitted& e) { seen += e.radiance * light; });
  paths_.direct.set(lane, seen);
}

// What an unlit surface shows to the camera, also in a mirror. It is the end of the path.
void Integrator::show_unlit(int lane) {
  const Path& path = this->path(lane);
  if (!scene_.materials().unlit(path.surface.material)) return;
  if (paths_.left_pdf[lane] == 0) {
    const Color shown = scene_.materials().shown(scene_.geometry(), path.hit, path.surface);
    paths_.emission.set(lane, paths_.emission.at(lane) + paths_.throughput.at(lane) * shown);
  }
  end(lane);
}

void Integrator::ask_light(int lane, const RayTraits& traits) {
  Path& path = this->path(lane);
  const Lights& lights = scene_.lights();
  const auto i = static_cast<std::size_t>(lane);
  const LightSample light = lights.sample(path.surface.position, path.bsdf.frame.z,
                                          lights.picks() ? which_.y[i] : 0, light_point_[i], path.time);
  if (!(light.pdf > 0)) return;
  const BsdfValue scattered = evaluate(path.bsdf, light.direction);
  const float weight = (light.delta ? 1.0f : power_heuristic(light.pdf, scattered.pdf)) / light.pdf;
  const Color f = scattered.diffuse * light.traits->diffuse + scattered.specular * light.traits->specular;
  Color waiting = paths_.throughput.at(lane) * f * light.radiance * weight;
  if (is_black(waiting)) return;
  const Vec3 origin = leaving(path.surface, light.direction);
  if (light.infinite)
    shadows_.set(lane, origin, light.direction, kFar, traits);
  else
    shadows_.set(lane, origin, light.target - origin, 1, traits);
  if (const Color absorption = paths_.absorption.at(lane); !light.infinite && !is_black(absorption))
    waiting *= attenuation(absorption, length(light.target - origin));
  paths_.waits[lane] = -1;
  paths_.waiting_light.set(lane, waiting);
  paths_.waiting_sent[lane] = luminance(light.radiance) * weight;
  path.asked = light.traits;
}

void Integrator::collect_light(int bounce, SampleBlock& out) {
  if (!any(paths_.waits)) return;
  scene_.bvh().occluded(shadows_);
  add_waiting(paths_.waits & ~shadows_.occluded(), bounce, out);
  paths_.waits = Mask{};
}

void Integrator::find_sky(int lane, int bounce, SampleBlock& out) {
  scene_.lights().escaped(paths_.left(lane), paths_.direction.at(lane),
                          [&](const Emitted& e) { add(lane, bounce, arriving(lane, e), out); });
}

Contribution Integrator::arriving(int lane, const Emitted& found) const {
  Color light = paths_.throughput.at(lane) * found.radiance;
  const LightTraits& t = *found.traits;
  if (paths_.vertices[lane] > 0 && scene_.parts_light()) {
    const Color diffuse = paths_.diffuse_share.at(lane);
    light *= diffuse * t.diffuse + (Color(1, 1, 1) - diffuse) * t.specular;
  }
  return {light, luminance(found.radiance), found.traits};
}

// To what scattering made of light at vertex `bounce`; -1: to what the camera sees of an emitter.
void Integrator::add(int lane, int bounce, Contribution c, SampleBlock& out) {
  paths_.sent[lane] += c.sent;
  const float most = bounce > 0 ? settings_.clamp_indirect : settings_.clamp_direct;
  if (bounce >= 0 && most > 0)
    if (const float brightest = max_component(c.light); brightest > most) c.light *= most / brightest;
  sum(bounce).set(lane, sum(bounce).at(lane) + c.light);
  if (groups_) add_to_group(lane, *c.traits, c.light, out);
}

// The same of what waited for shadow rays.
void Integrator::add_waiting(const Mask& seen, int bounce, SampleBlock& out) {
  paths_.sent += seen ? paths_.waiting_sent : Wide{};
  Wide3 light = chosen(seen, paths_.waiting_light, Wide3{});
  const float most = bounce > 0 ? settings_.clamp_indirect : settings_.clamp_direct;
  if (most > 0) {
    const Wide brightest = max_component(light);
    light = light * (brightest > most ? most / brightest : wide(1.0f));
  }
  sum(bounce) = sum(bounce) + light;
  if (groups_) each_lane(seen, [&](int lane) { add_to_group(lane, *path(lane).asked, light.at(lane), out); });
}

void Integrator::add_to_group(int lane, const LightTraits& traits, const Color& light,
                              SampleBlock& out) const {
  if (traits.group < 0) return;
  const Aov group = light_group_aov(traits.group);
  if (!out.has(group)) return;
  for (int k = 0; k < 3; ++k) out.channel(group, k)[static_cast<std::size_t>(lane)] += light[k];
}

}  // namespace tessera::tracer
