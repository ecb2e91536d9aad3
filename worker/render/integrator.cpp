// SPDX-License-Identifier: Apache-2.0
#include "worker/render/integrator.h"

#include "core/scene/load.h"

namespace tessera::tracer {
namespace {

// How much of a pixel's width a camera ray stands for: a frame begins with 16 samples a pixel, and what lies
// between them the mean over the samples smooths.
constexpr float kPixelShare = 0.25f;

// How much of the angle of a bundle of rays, one a sample, the cone of one ray is made: pictures seen by
// reflection may blur that much.
constexpr float kConeShare = 0.1f;

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
    clear(rays_);
    clear(shadows_);
    for (int lane = 0; lane < kLanes; ++lane)
      if (paths_[static_cast<std::size_t>(lane)].alive) scatter(turn, lane, bounce, out);
    collect_light(bounce, out);
    next_hits(bounce, out);
  }
  finish(turn, out);
  if (sample == 0 && guides_.samples_points()) guides_.point_samples(block, rays_, out);
}

RayTraits Integrator::traits(const Turn& turn, int lane, int bounce, RayKind kind) const {
  const auto i = static_cast<std::size_t>(lane);
  RayTraits t{paths_[i].ray.time, kind, 0};
  if (scene_.blends())
    t.seed = static_cast<std::uint32_t>(
        mixed(turn.keys[i] ^ (static_cast<std::uint64_t>(turn.sample) << 32 |
                              static_cast<std::uint32_t>(4 * bounce + static_cast<int>(kind)))));
  return t;
}

// Where the sample in hand lies, in pixels.
Vec2 Integrator::screen(const BlockKeys& block, std::size_t lane) const {
  const int l = static_cast<int>(lane);
  return {static_cast<float>(block.x + l % kBlockEdge) + pixel_.x[lane],
          static_cast<float>(block.y + l / kBlockEdge) + pixel_.y[lane]};
}

void Integrator::start(const Turn& turn) {
  const CameraRays& camera = views_.now;
  pixel_.draw(turn.keys, turn.index, kPixelSet);
  if (camera.has_lens()) lens_.draw(turn.keys, turn.index, kLensSet);
  if (moving_) time_.draw(turn.keys, turn.index, kTimeSet);
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    Path& path = paths_[i];
    path.ray.time = moving_ ? time_.x[i] : 0;
    path.ray = traits(turn, lane, 0, RayKind::camera);
    const Vec2 at = screen(turn.block, i);
    const Ray ray = camera.ray(at.x, at.y, camera.has_lens() ? lens_[i] : Vec2(0, 0), path.ray.time);
    path.origin = ray.origin;
    path.direction = ray.direction;
    path.throughput = Color(1, 1, 1);
    path.radiance_scale = 1;
    path.diffuse_share = path.absorption = Color(0, 0, 0);
    path.width = kPixelShare * camera.footprint();
    path.spread = kPixelShare * camera.spread();
    path.left = {};
    path.direct = path.indirect = path.emission = Color(0, 0, 0);
    path.sent = 0;
    path.vertices = 0;
    path.alive = path.texture2 = true;
    path.waits = path.rough = false;
    rays_.set(lane, ray.origin, ray.direction, kFar, path.ray);
  }
}

// Draws the random numbers that the living paths need at their next vertex. False if there are none.
bool Integrator::ready_vertices(const Turn& turn, int bounce) {
  bool any = false, lobes = false;
  for (const Path& path : paths_) {
    any |= path.alive;
    lobes |= path.alive && !one_lobe(path.bsdf);
  }
  if (!any) return false;
  const std::uint32_t set = first_set(bounce);
  const Lights& lights = scene_.lights();
  if (!lights.empty()) light_point_.draw(turn.keys, turn.index, set);
  direction_.draw(turn.keys, turn.index, set + 1);
  if (lobes || lights.picks()) which_.draw(turn.keys, turn.index, set + 2);
  if (bounce >= settings_.sure_bounces) roulette_.draw(turn.keys, turn.index, set + 3);
  return true;
}

void Integrator::ready_bsdf(Path& path) const {
  path.bsdf = scene_.materials().bsdf(scene_.geometry(), path.hit, path.surface, path.direction);
}

void Integrator::first_hit(const Turn& turn, int lane, SampleBlock& out) {
  Path& path = paths_[static_cast<std::size_t>(lane)];
  ready_bsdf(path);
  guides_.first_hit(path, lane, out);
  const int object = scene_.geometry().object(path.hit);
  if (object >= 0 && scene_.scene().objects[static_cast<std::size_t>(object)].catcher)
    return catch_shadow(turn, lane, out);
  if (path.surface.light >= 0)
    add(path, lane, -1, arriving(path, scene_.lights().hit({}, path.direction, path.surface)), out);
  show_unlit(path);
}

// At a vertex: sends a shadow ray to a light, and the path on.
void Integrator::scatter(const Turn& turn, int lane, int bounce, SampleBlock& out) {
  Path& path = paths_[static_cast<std::size_t>(lane)];
  const auto i = static_cast<std::size_t>(lane);
  ++path.vertices;
  if (!path.bsdf.delta && !scene_.lights().empty()) {
    path.ray = traits(turn, lane, bounce, RayKind::shadow);
    ask_light(path, lane);
  }
  path.alive = bounce < settings_.max_bounces || scene_.lights().sky_emits() || surfaces_shine();
  if (!path.alive) return;
  const BsdfSample s = sample(path.bsdf, one_lobe(path.bsdf) ? 0 : which_.x[i], direction_[i]);
  path.alive = !is_black(s.weight());
  if (!path.alive) return;
  go_on(path, s);
  if (bounce == 0) guides_.first_bounce(path, lane, out);
  path.alive = survives(path, lane, bounce);
  if (!path.alive) return;
  path.ray = traits(turn, lane, bounce, RayKind::scattered);
  rays_.set(lane, path.origin, s.wi, kFar, path.ray);
}

void Integrator::go_on(Path& path, const BsdfSample& s) const {
  const Color weight = s.weight();
  path.throughput *= weight;
  path.radiance_scale *= s.radiance_scale;
  if (scene_.parts_light())
    for (int c = 0; c < 3; ++c) path.diffuse_share[c] = weight[c] > 0 ? s.diffuse[c] / weight[c] : 0;
  if (s.crossed) path.absorption = dot(s.wi, path.surface.ng) < 0 ? path.bsdf.absorption : Color(0, 0, 0);
  if (s.pdf > 0) {
    path.rough = true;
    path.spread += kConeShare / std::sqrt(s.pdf);
  }
  path.left = {path.surface.position, path.bsdf.frame.z, s.pdf};
  path.direction = s.wi;
  path.origin = leaving(path.surface, s.wi);
}

bool Integrator::surfaces_shine() const { return scene_.lights().surfaces_emit() || scene_.shows_unlit(); }

// Russian roulette on what the path can still carry.
bool Integrator::survives(Path& path, int lane, int bounce) const {
  if (bounce < settings_.sure_bounces || bounce == settings_.max_bounces) return true;
  // The root of what is carried: on a scene of mostly diffuse bounces the least error for the time.
  const float chance = std::sqrt(max_component(path.throughput) / path.radiance_scale);
  if (chance >= 1) return true;
  if (roulette_.x[static_cast<std::size_t>(lane)] >= chance) return false;
  path.throughput *= 1.0f / chance;
  return true;
}

void Integrator::next_hits(int bounce, SampleBlock& out) {
  if (bounce == settings_.max_bounces && !surfaces_shine()) return last_hits(bounce, out);
  scene_.bvh().intersect(rays_);
  find_surfaces();
  for (int lane = 0; lane < kLanes; ++lane)
    if (paths_[static_cast<std::size_t>(lane)].alive) arrive(lane, bounce, out);
}

// What is hit does not matter any more, only whether the sky is seen.
void Integrator::last_hits(int bounce, SampleBlock& out) {
  clear(shadows_);
  bool any = false;
  for (int lane = 0; lane < kLanes; ++lane) {
    const Path& path = paths_[static_cast<std::size_t>(lane)];
    if (!path.alive) continue;
    shadows_.set(lane, path.origin, path.direction, kFar, path.ray);
    any = true;
  }
  if (!any) return;
  scene_.bvh().occluded(shadows_);
  for (int lane = 0; lane < kLanes; ++lane) {
    Path& path = paths_[static_cast<std::size_t>(lane)];
    if (path.alive && !shadows_.occluded(lane)) find_sky(path, lane, bounce, out);
  }
}

// All lanes first, and memory asked before it is needed: the lanes wait for it at the same time then.
void Integrator::find_surfaces() {
  const Geometry& geometry = scene_.geometry();
  std::array<std::size_t, kLanes> hits;
  std::size_t count = 0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const int lane = static_cast<int>(i);
    if (!paths_[i].alive || !rays_.hit(lane)) continue;
    hits[count++] = i;
    paths_[i].hit = rays_.at(lane);
    geometry.prefetch_indices(paths_[i].hit);
  }
  for (std::size_t k = 0; k < count; ++k) geometry.prefetch_corners(paths_[hits[k]].hit);
  for (std::size_t k = 0; k < count; ++k) {
    Path& path = paths_[hits[k]];
    const float distance = rays_.distance(static_cast<int>(hits[k]));
    path.width += path.spread * distance;
    path.surface = geometry.surface(path.hit, path.origin, path.direction, distance, path.ray.time);
    path.surface.cone = path.width;
  }
}

// At the end of a ray that was scattered at vertex `bounce`: collects emission, and readies the next vertex.
void Integrator::arrive(int lane, int bounce, SampleBlock& out) {
  Path& path = paths_[static_cast<std::size_t>(lane)];
  if (!rays_.hit(lane)) {
    find_sky(path, lane, bounce, out);
    path.alive = false;
    return;
  }
  if (!is_black(path.absorption)) path.throughput *= attenuation(path.absorption, rays_.distance(lane));
  if (path.surface.light >= 0)
    add(path, lane, bounce, arriving(path, scene_.lights().hit(path.left, path.direction, path.surface)),
        out);
  show_unlit(path);
  if (bounce == settings_.max_bounces || !path.alive) return;
  ready_bsdf(path);
  if (settings_.regularise > 0 && path.rough) regularise(path.bsdf, settings_.regularise);
  guides_.later_hit(path, lane, bounce, out);
}

void Integrator::finish(const Turn& turn, SampleBlock& out) const {
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    const Path& path = paths_[i];
    const Color color = path.direct + path.indirect + path.emission;
    out.valid[i] = 1;
    out.set(Aov::color, lane, color);
    out.set(Aov::direct, lane, path.direct);
    out.set(Aov::indirect, lane, path.indirect);
    out.set(Aov::emission, lane, path.emission);
    guides_.sample(lane, path, color, screen(turn.block, i),
                   views_.now.has_lens() ? lens_[i] : Vec2(0.5f, 0.5f), out);
    if (!is_finite(color)) out.drop(i);
  }
}

}  // namespace tessera::tracer
