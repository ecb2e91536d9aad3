// SPDX-License-Identifier: Apache-2.0
#include "worker/render/integrator.h"

#include <limits>

#include "core/scene/load.h"
#include "worker/render/warp.h"

namespace tessera::tracer {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

// Bounces before Russian roulette begins.
constexpr int kSureBounces = 2;

// The sets of random numbers: two for the camera, then four a vertex.
constexpr std::uint32_t kPixelSet = 0, kLensSet = 1;
std::uint32_t first_set(int vertex) { return 2 + 4 * static_cast<std::uint32_t>(vertex); }

template <typename P>
void clear(P& packet) {
  for (int& active : packet.active) active = 0;
}

// Off the surface on the side that `direction` leaves to.
Vec3 leaving(const Surface& s, const Vec3& direction) {
  return offset_origin(s.position, dot(direction, s.ng) >= 0 ? s.ng : -s.ng);
}

}  // namespace

BlockKeys::BlockKeys(std::uint64_t seed, int frame, int x0, int y0) : x(x0), y(y0) {
  for (int h = 0; h < 2; ++h)
    for (int i = 0; i < kBlockPixels; ++i)
      half[static_cast<std::size_t>(h)][static_cast<std::size_t>(i)] =
          half_key(seed, frame, x0 + i % kBlockEdge, y0 + i / kBlockEdge, h);
}

Integrator::Integrator(const RenderScene& scene, const RenderSettings& settings)
    : scene_(scene),
      camera_(scene.scene().cameras[camera_index(scene.scene(), settings.camera)], settings.size),
      max_bounces_(settings.max_bounces),
      albedo_(settings.aovs.has(Aov::albedo)) {}

void Integrator::trace(const BlockKeys& block, int sample, SampleBlock& out) {
  start(block, sample);
  scene_.bvh().intersect_coherent(rays_);
  find_surfaces();
  for (int lane = 0; lane < kLanes; ++lane) rays_.hit(lane) ? first_hit(lane, out) : sky(lane, out);
  for (int bounce = 0; bounce <= max_bounces_; ++bounce) {
    if (!ready_vertices(block, sample, bounce)) break;
    clear(rays_);
    clear(shadows_);
    for (int lane = 0; lane < kLanes; ++lane)
      if (paths_[static_cast<std::size_t>(lane)].alive) scatter(lane, bounce);
    collect_light(bounce);
    next_hits(bounce);
  }
  finish(out);
}

void Integrator::start(const BlockKeys& block, int sample) {
  const auto& keys = block.half[static_cast<std::size_t>(sample & 1)];
  RandomPairs<kLanes> pixel, lens;
  pixel.draw(keys, half_index_reversed(sample), kPixelSet);
  if (camera_.has_lens()) lens.draw(keys, half_index_reversed(sample), kLensSet);
  for (int lane = 0; lane < kLanes; ++lane) {
    Path& path = paths_[static_cast<std::size_t>(lane)];
    const Vec2 within = pixel[static_cast<std::size_t>(lane)];
    const Ray ray = camera_.ray(static_cast<float>(block.x + lane % kBlockEdge) + within.x,
                                static_cast<float>(block.y + lane / kBlockEdge) + within.y,
                                camera_.has_lens() ? lens[static_cast<std::size_t>(lane)] : Vec2(0, 0));
    path.origin = ray.origin;
    path.direction = ray.direction;
    path.throughput = Color(1, 1, 1);
    path.radiance_scale = 1;
    path.left = {};
    path.direct = path.indirect = path.emission = Color(0, 0, 0);
    path.alive = true;
    path.waits = false;
    rays_.set(lane, ray.origin, ray.direction, kFar);
  }
}

// Draws the random numbers that the living paths need at their next vertex. False if there are none.
bool Integrator::ready_vertices(const BlockKeys& block, int sample, int bounce) {
  bool any = false, lobes = false;
  for (const Path& path : paths_) {
    any |= path.alive;
    lobes |= path.alive && !one_lobe(path.bsdf);
  }
  if (!any) return false;
  const auto& keys = block.half[static_cast<std::size_t>(sample & 1)];
  const std::uint32_t index = half_index_reversed(sample), set = first_set(bounce);
  const Lights& lights = scene_.lights();
  if (!lights.empty()) light_point_.draw(keys, index, set);
  direction_.draw(keys, index, set + 1);
  if (lobes || lights.picks()) which_.draw(keys, index, set + 2);
  if (bounce >= kSureBounces) roulette_.draw(keys, index, set + 3);
  return true;
}

void Integrator::first_hit(int lane, SampleBlock& out) {
  Path& path = paths_[static_cast<std::size_t>(lane)];
  path.bsdf = scene_.materials().bsdf(scene_.geometry(), rays_.at(lane), path.surface, path.direction);
  if (path.surface.light >= 0) path.emission = scene_.lights().hit({}, path.direction, path.surface).radiance;
  out.hit[static_cast<std::size_t>(lane)] = 1;
  out.set(Aov::albedo, lane, albedo_ ? albedo(path.bsdf) : Color(0, 0, 0));
  out.set(Aov::normal, lane, path.bsdf.frame.z);
  out.set(Aov::position, lane, path.surface.position);
  out.values[SampleBlock::channel(Aov::depth)][static_cast<std::size_t>(lane)] =
      dot(path.surface.position - camera_.origin(), camera_.forward());
}

void Integrator::sky(int lane, SampleBlock& out) {
  Path& path = paths_[static_cast<std::size_t>(lane)];
  path.alive = false;
  scene_.lights().backdrop(path.direction, [&](const Emitted& e) { path.emission += e.radiance; });
  out.hit[static_cast<std::size_t>(lane)] = 0;
  out.set(Aov::albedo, lane, Vec3(1, 1, 1));
  out.set(Aov::normal, lane, Vec3(0, 0, 0));
  out.set(Aov::position, lane, camera_.origin() + path.direction * scene_.diameter());
  out.values[SampleBlock::channel(Aov::depth)][static_cast<std::size_t>(lane)] = 0;
}

// At a vertex: sends a shadow ray to a light, and the path on.
void Integrator::scatter(int lane, int bounce) {
  Path& path = paths_[static_cast<std::size_t>(lane)];
  if (!path.bsdf.delta && !scene_.lights().empty()) ask_light(path, lane);
  path.alive = bounce < max_bounces_ || gathers_emission();
  if (!path.alive) return;
  const auto i = static_cast<std::size_t>(lane);
  const BsdfSample s = sample(path.bsdf, one_lobe(path.bsdf) ? 0 : which_.x[i], direction_[i]);
  path.alive = !is_black(s.weight());
  if (!path.alive) return;
  path.throughput *= s.weight();
  path.radiance_scale *= s.radiance_scale;
  path.left = {path.surface.position, path.bsdf.frame.z, s.pdf};
  path.direction = s.wi;
  path.alive = survives(path, lane, bounce);
  if (!path.alive) return;
  path.origin = leaving(path.surface, s.wi);
  rays_.set(lane, path.origin, s.wi, kFar);
}

bool Integrator::gathers_emission() const {
  return scene_.lights().sky_emits() || scene_.lights().surfaces_emit();
}

// Russian roulette on what the path can still carry.
bool Integrator::survives(Path& path, int lane, int bounce) const {
  if (bounce < kSureBounces || bounce == max_bounces_) return true;
  // The root of what is carried: on a scene of mostly diffuse bounces the least error for the time.
  const float chance = std::sqrt(max_component(path.throughput) / path.radiance_scale);
  if (chance >= 1) return true;
  if (roulette_.x[static_cast<std::size_t>(lane)] >= chance) return false;
  path.throughput *= 1.0f / chance;
  return true;
}

void Integrator::ask_light(Path& path, int lane) {
  const Lights& lights = scene_.lights();
  const auto i = static_cast<std::size_t>(lane);
  const LightSample light = lights.sample(path.surface.position, path.bsdf.frame.z,
                                          lights.picks() ? which_.y[i] : 0, light_point_[i]);
  if (!(light.pdf > 0)) return;
  const BsdfValue scattered = evaluate(path.bsdf, light.direction);
  const float weight = (light.delta ? 1.0f : power_heuristic(light.pdf, scattered.pdf)) / light.pdf;
  path.unshadowed = path.throughput * scattered.f() * light.radiance * weight;
  if (is_black(path.unshadowed)) return;
  path.waits = true;
  const Vec3 origin = leaving(path.surface, light.direction);
  if (light.infinite)
    shadows_.set(lane, origin, light.direction, kFar);
  else
    shadows_.set(lane, origin, light.target - origin, 1);
}

void Integrator::collect_light(int bounce) {
  bool any = false;
  for (const Path& path : paths_) any |= path.waits;
  if (!any) return;
  scene_.bvh().occluded(shadows_);
  for (int lane = 0; lane < kLanes; ++lane) {
    Path& path = paths_[static_cast<std::size_t>(lane)];
    if (path.waits && !shadows_.occluded(lane))
      (bounce == 0 ? path.direct : path.indirect) += path.unshadowed;
    path.waits = false;
  }
}

void Integrator::next_hits(int bounce) {
  const bool last = bounce == max_bounces_;
  if (last && !scene_.lights().surfaces_emit()) {
    // What is hit does not matter any more, only whether the sky is seen.
    clear(shadows_);
    bool any = false;
    for (int lane = 0; lane < kLanes; ++lane) {
      const Path& path = paths_[static_cast<std::size_t>(lane)];
      if (!path.alive) continue;
      shadows_.set(lane, path.origin, path.direction, kFar);
      any = true;
    }
    if (!any) return;
    scene_.bvh().occluded(shadows_);
    for (int lane = 0; lane < kLanes; ++lane) {
      Path& path = paths_[static_cast<std::size_t>(lane)];
      if (!path.alive || shadows_.occluded(lane)) continue;
      find_sky(path, bounce);
    }
    return;
  }
  scene_.bvh().intersect(rays_);
  find_surfaces();
  for (int lane = 0; lane < kLanes; ++lane)
    if (paths_[static_cast<std::size_t>(lane)].alive) arrive(lane, bounce);
}

// All lanes first, for they wait for memory at the same time then.
void Integrator::find_surfaces() {
  for (int lane = 0; lane < kLanes; ++lane) {
    Path& path = paths_[static_cast<std::size_t>(lane)];
    if (!path.alive || !rays_.hit(lane)) continue;
    path.surface =
        scene_.geometry().surface(rays_.at(lane), path.origin, path.direction, rays_.distance(lane));
  }
}

// At the end of a ray that was scattered at vertex `bounce`: collects emission, and readies the next vertex.
void Integrator::arrive(int lane, int bounce) {
  Path& path = paths_[static_cast<std::size_t>(lane)];
  Color& light = bounce == 0 ? path.direct : path.indirect;
  if (!rays_.hit(lane)) {
    find_sky(path, bounce);
    path.alive = false;
    return;
  }
  if (path.surface.light >= 0)
    light += path.throughput * scene_.lights().hit(path.left, path.direction, path.surface).radiance;
  if (bounce < max_bounces_)
    path.bsdf = scene_.materials().bsdf(scene_.geometry(), rays_.at(lane), path.surface, path.direction);
}

void Integrator::find_sky(Path& path, int bounce) const {
  Color& light = bounce == 0 ? path.direct : path.indirect;
  scene_.lights().escaped(path.left, path.direction,
                          [&](const Emitted& e) { light += path.throughput * e.radiance; });
}

void Integrator::finish(SampleBlock& out) const {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const Path& path = paths_[lane];
    const Color color = path.direct + path.indirect + path.emission;
    out.valid[lane] = is_finite(color) ? 1.0f : 0.0f;
    out.set(Aov::color, static_cast<int>(lane), color);
    out.set(Aov::direct, static_cast<int>(lane), path.direct);
    out.set(Aov::indirect, static_cast<int>(lane), path.indirect);
    out.set(Aov::emission, static_cast<int>(lane), path.emission);
    if (out.valid[lane] != 0) continue;
    for (Lane& value : out.values) value[lane] = 0;
    out.hit[lane] = 0;
  }
}

}  // namespace tessera::tracer
