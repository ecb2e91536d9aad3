// SPDX-License-Identifier: Apache-2.0
#include "worker/render/integrator.h"

#include "core/scene/load.h"

namespace tessera::tracer {
namespace {

// How much of a pixel's width a camera ray stands for: a frame begins with 16 samples a pixel, and what lies
// between them the mean over the samples smooths.
constexpr float kPixelShare = 0.25f;

Views views_of(const RenderScene& scene, const RenderSettings& settings, int frame) {
  const Scene& s = scene.scene();
  const Camera& camera = s.cameras[camera_index(s, settings.camera)];
  const auto at = [&](double number) {
    const Shutter shutter = shutter_of(s, camera, number);
    return CameraRays(s, camera, settings.size, shutter.open, shutter.close);
  };
  return {at(frame), at(frame - 1.0), at(frame + 1.0)};
}

}  // namespace

Integrator::Integrator(const RenderScene& scene, const RenderSettings& settings, int frame)
    : scene_(scene),
      settings_(settings),
      views_(views_of(scene, settings, frame)),
      guides_(scene, settings.aovs, views_),
      moving_(views_.now.moves() || scene.moves()),
      groups_(!scene.scene().light_groups.empty()) {
  const Background& b = scene.scene().background;
  backdrop_ = b.kind == Background::Kind::color ? b.color : Color(0, 0, 0);
  const Camera& camera = scene.scene().cameras[camera_index(scene.scene(), settings.camera)];
  if (camera.autofocus && views_.now.has_lens()) focus();
}

// On what the middle of the frame shows; on nothing there: as the camera says.
void Integrator::focus() {
  const float x = static_cast<float>(settings_.size.width) / 2,
              y = static_cast<float>(settings_.size.height) / 2;
  const Ray ray = views_.now.central_ray(x, y, 0.5f);
  clear(rays_);
  rays_.set(0, ray.origin, ray.direction, kFar, {0.5f, RayKind::camera, 0});
  scene_.bvh().intersect(rays_);
  if (!rays_.hit(0)) return;
  const float depth = views_.now.depth(ray.origin + ray.direction * rays_.distance(0), 0.5f);
  if (depth > 0) views_.now.focus_at(depth);
}

void Integrator::trace(const BlockKeys& block, int sample, SampleBlock& out) {
  const Turn turn{block, sample, block.half[static_cast<std::size_t>(sample & 1)],
                  half_index_reversed(sample)};
  out.clear();
  start(turn);
  scene_.bvh().intersect_coherent(rays_);
  find_surfaces();
  for (int lane = 0; lane < kLanes; ++lane) rays_.hit(lane) ? first_hit(turn, lane, out) : sky(lane, out);
  for (int bounce = 0; bounce <= settings_.max_bounces; ++bounce) {
    if (!ready_vertices(turn, bounce)) break;
    const Mask others = paths_.alive & ~paths_.lambert;
    scatter_lambert(turn, bounce, out);
    each_lane(others, [&](int lane) { scatter(turn, lane, bounce, out); });
    collect_light(bounce, out);
    next_hits(bounce, out);
  }
  finish(turn, out);
  if (sample == 0 && guides_.samples_points()) guides_.point_samples(block, rays_, out);
}

RayTraits Integrator::traits(const Turn& turn, int lane, int bounce, RayKind kind) const {
  const auto i = static_cast<std::size_t>(lane);
  RayTraits t{paths_.lane[i].time, kind, 0};
  if (scene_.blends())
    t.seed = static_cast<std::uint32_t>(
        mixed(turn.keys[i] ^ (static_cast<std::uint64_t>(turn.sample) << 32 |
                              static_cast<std::uint32_t>(4 * bounce + static_cast<int>(kind)))));
  return t;
}

WideInt Integrator::seeds(const Turn& turn, const Mask& lanes, int bounce, RayKind kind) const {
  WideInt all{};
  if (scene_.blends())
    each_lane(lanes, [&](int lane) {
      all[lane] = static_cast<std::int32_t>(traits(turn, lane, bounce, kind).seed);
    });
  return all;
}

// Where the sample in hand lies, in pixels.
Vec2 Integrator::screen(const BlockKeys& block, std::size_t lane) const {
  const int l = static_cast<int>(lane);
  return {static_cast<float>(block.x + l % kBlockEdge) + pixel_.x[lane],
          static_cast<float>(block.y + l / kBlockEdge) + pixel_.y[lane]};
}

WideRay Integrator::camera_rays(const Turn& turn) const {
  const CameraRays& camera = views_.now;
  Wide2 at;
  for (int lane = 0; lane < kLanes; ++lane) {
    const Vec2 pixel = screen(turn.block, static_cast<std::size_t>(lane));
    at.x[lane] = pixel.x;
    at.y[lane] = pixel.y;
  }
  if (camera.pinhole()) return camera.pinhole_rays(at);
  WideRay rays;
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    const Ray ray = camera.ray(at.x[lane], at.y[lane], camera.has_lens() ? lens_[i] : Vec2(0, 0),
                               moving_ ? time_.x[i] : 0);
    rays.origin.set(lane, ray.origin);
    rays.direction.set(lane, ray.direction);
  }
  return rays;
}

void Integrator::start(const Turn& turn) {
  const CameraRays& camera = views_.now;
  pixel_.draw(turn.keys, turn.index, kPixelSet);
  if (camera.has_lens()) lens_.draw(turn.keys, turn.index, kLensSet);
  if (moving_) time_.draw(turn.keys, turn.index, kTimeSet);
  for (std::size_t i = 0; i < kLanes; ++i) {
    paths_.lane[i].time = moving_ ? time_.x[i] : 0;
    paths_.lane[i].texture2 = true;
  }
  const WideRay rays = camera_rays(turn);
  paths_.begin();
  paths_.origin = rays.origin;
  paths_.direction = rays.direction;
  paths_.width = wide(kPixelShare * camera.footprint());
  paths_.spread = wide(kPixelShare * camera.spread());
  rays_time_ = moving_ ? load(time_.x.data()) : Wide{};
  rays_.set(paths_.alive, {paths_.origin, paths_.direction, wide(kFar), rays_time_, RayKind::camera,
                           seeds(turn, paths_.alive, 0, RayKind::camera)});
}

// Draws the random numbers that the living paths need at their next vertex. False if there are none.
bool Integrator::ready_vertices(const Turn& turn, int bounce) {
  if (!any(paths_.alive)) return false;
  bool lobes = false;
  each_lane(paths_.alive & ~paths_.lambert, [&](int lane) { lobes |= !one_lobe(path(lane).bsdf); });
  const std::uint32_t set = first_set(bounce);
  const Lights& lights = scene_.lights();
  if (!lights.empty()) light_point_.draw(turn.keys, turn.index, set);
  direction_.draw(turn.keys, turn.index, set + 1);
  if (lobes || lights.picks()) which_.draw(turn.keys, turn.index, set + 2);
  if (bounce >= settings_.sure_bounces) roulette_.draw_first(turn.keys, turn.index, set + 3);
  return true;
}

void Integrator::scatter(const Turn& turn, int lane, int bounce, SampleBlock& out) {
  Path& path = this->path(lane);
  const auto i = static_cast<std::size_t>(lane);
  paths_.vertices[lane] += 1;
  end(lane);
  if (!path.bsdf.delta && !scene_.lights().empty())
    ask_light(lane, traits(turn, lane, bounce, RayKind::shadow));
  if (bounce == settings_.max_bounces && !scene_.lights().sky_emits() && !surfaces_shine()) return;
  const BsdfSample s = sample(path.bsdf, one_lobe(path.bsdf) ? 0 : which_.x[i], direction_[i]);
  if (is_black(s.weight())) return;
  go_on(lane, s);
  if (bounce == 0) guides_.first_bounce(paths_, lane, out);
  if (!survives(lane, bounce)) return;
  paths_.alive[lane] = -1;
  rays_.set(lane, paths_.origin.at(lane), s.wi, kFar, traits(turn, lane, bounce, RayKind::scattered));
}

void Integrator::go_on(int lane, const BsdfSample& s) {
  const Path& path = this->path(lane);
  const Color weight = s.weight();
  paths_.throughput.set(lane, paths_.throughput.at(lane) * weight);
  paths_.radiance_scale[lane] *= s.radiance_scale;
  if (scene_.parts_light()) {
    Color share;
    for (int c = 0; c < 3; ++c) share[c] = weight[c] > 0 ? s.diffuse[c] / weight[c] : 0;
    paths_.diffuse_share.set(lane, share);
  }
  if (s.crossed)
    paths_.absorption.set(lane, dot(s.wi, path.surface.ng) < 0 ? path.bsdf.absorption : Color(0, 0, 0));
  if (s.pdf > 0) {
    paths_.rough[lane] = -1;
    paths_.spread[lane] += kConeShare / std::sqrt(s.pdf);
  }
  paths_.leave(lane, {path.surface.position, path.bsdf.frame.z, s.pdf});
  paths_.direction.set(lane, s.wi);
  paths_.origin.set(lane, leaving(path.surface, s.wi));
}

bool Integrator::surfaces_shine() const { return scene_.lights().surfaces_emit() || scene_.shows_unlit(); }

// Russian roulette on what the path can still carry.
bool Integrator::survives(int lane, int bounce) {
  if (bounce < settings_.sure_bounces || bounce == settings_.max_bounces) return true;
  const Color throughput = paths_.throughput.at(lane);
  // The root of what is carried: on a scene of mostly diffuse bounces the least error for the time.
  const float chance = std::sqrt(max_component(throughput) / paths_.radiance_scale[lane]);
  if (chance >= 1) return true;
  if (roulette_.x[static_cast<std::size_t>(lane)] >= chance) return false;
  paths_.throughput.set(lane, throughput * (1.0f / chance));
  return true;
}

void Integrator::finish(const Turn& turn, SampleBlock& out) const {
  out.valid.fill(1);
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    const Color direct = paths_.direct.at(lane), indirect = paths_.indirect.at(lane);
    const Color emission = paths_.emission.at(lane), color = direct + indirect + emission;
    out.set(Aov::color, lane, color);
    out.set(Aov::direct, lane, direct);
    out.set(Aov::indirect, lane, indirect);
    out.set(Aov::emission, lane, emission);
    guides_.sample(lane, paths_, color, screen(turn.block, i),
                   views_.now.has_lens() ? lens_[i] : Vec2(0.5f, 0.5f), out);
    if (!is_finite(color)) out.drop(i);
  }
}

}  // namespace tessera::tracer
