// SPDX-License-Identifier: Apache-2.0
#include "worker/render/guides.h"

#include "core/cryptomatte.h"

namespace tessera::tracer {
namespace {

constexpr float kMiddle = 0.5f;  // of the shutter

constexpr std::initializer_list<Aov> kPointAovs{Aov::motion,      Aov::previous_depth, Aov::geometric_normal,
                                                Aov::object_id,   Aov::material_id,    Aov::depth_gradient,
                                                Aov::next_motion, Aov::next_depth};

bool any_of(AovSet aovs, std::initializer_list<Aov> wanted) {
  return std::any_of(wanted.begin(), wanted.end(), [&](Aov a) { return aovs.has(a); });
}

std::vector<float> matte_ids(const auto& named) {
  std::vector<float> ids;
  for (const auto& n : named) ids.push_back(n.name.empty() ? 0 : matte_id(n.name));
  return ids;
}

}  // namespace

Guides::Guides(const RenderScene& scene, AovSet aovs, const Views& views)
    : scene_(scene),
      views_(views),
      albedo_(any_of(aovs, {Aov::albedo, Aov::sample_vectors})),
      vectors_(aovs.has(Aov::sample_vectors)),
      points_(any_of(aovs, kPointAovs)) {
  if (aovs.has(Aov::object_matte)) object_mattes_ = matte_ids(scene.scene().objects);
  if (aovs.has(Aov::material_matte)) material_mattes_ = matte_ids(scene.scene().materials);
}

void Guides::vector_part(int at, int lane, const Vec3& v, SampleBlock& out) const {
  for (int c = 0; c < 3; ++c) out.channel(Aov::sample_vectors, at + c)[static_cast<std::size_t>(lane)] = v[c];
}

void Guides::first_hit(const Paths& paths, int lane, SampleBlock& out) const {
  const Path& path = paths.lane[static_cast<std::size_t>(lane)];
  const Vec3 normal = paths.normal.at(lane);
  out.hit[static_cast<std::size_t>(lane)] = 1;
  const Color reflectance = albedo_ ? paths.albedo(lane) : Color(0, 0, 0);
  out.set(Aov::albedo, lane, reflectance);
  out.set(Aov::normal, lane, normal);
  out.set(Aov::position, lane, path.surface.position);
  if (out.has(Aov::depth)) out.set(Aov::depth, lane, views_.now.depth(path.surface.position, path.time));
  if (!object_mattes_.empty())
    if (const int object = scene_.geometry().object(path.hit); object >= 0)
      out.set(Aov::object_matte, lane, object_mattes_[static_cast<std::size_t>(object)]);
  if (!material_mattes_.empty())
    out.set(Aov::material_matte, lane, material_mattes_[static_cast<std::size_t>(path.surface.material)]);
  if (!vectors_) return;
  vector_part(SampleVector::position, lane, path.surface.position, out);
  vector_part(SampleVector::normal, lane, normal, out);
  vector_part(SampleVector::albedo, lane, reflectance, out);
}

void Guides::sky(const Paths& paths, int lane, SampleBlock& out) const {
  const Vec3 far = paths.origin.at(lane) + paths.direction.at(lane) * scene_.diameter();
  out.set(Aov::albedo, lane, Vec3(1, 1, 1));
  out.set(Aov::position, lane, far);
  if (vectors_) vector_part(SampleVector::position, lane, far, out);
}

void Guides::caught(const Paths& paths, int lane, float shadow, SampleBlock& out) const {
  const Path& path = paths.lane[static_cast<std::size_t>(lane)];
  out.set(Aov::albedo, lane, Vec3(1, 1, 1));
  if (vectors_) vector_part(SampleVector::albedo, lane, Vec3(1, 1, 1), out);
  out.hit[static_cast<std::size_t>(lane)] = shadow;
  if (out.has(Aov::depth))
    out.set(Aov::depth, lane, shadow * views_.now.depth(path.surface.position, path.time));
  if (shadow > 0) return;
  out.set(Aov::object_matte, lane, 0.0f);
  out.set(Aov::material_matte, lane, 0.0f);
}

void Guides::first_bounce(const Paths& paths, int lane, SampleBlock& out) const {
  out.set(Aov::bounce, lane, paths.direction.at(lane));
  if (vectors_) vector_part(SampleVector::bounce, lane, paths.direction.at(lane), out);
}

void Guides::later_hit(Paths& paths, int lane, int bounce, SampleBlock& out) const {
  Path& path = paths.lane[static_cast<std::size_t>(lane)];
  if (bounce == 0 && vectors_) {
    vector_part(SampleVector::position2, lane, path.surface.position, out);
    vector_part(SampleVector::normal2, lane, paths.normal.at(lane), out);
  }
  if (!path.texture2 || !out.has(Aov::texture2) || !paths.has_diffuse(lane)) return;
  out.set(Aov::texture2, lane, paths.albedo(lane));
  path.texture2 = false;
}

void Guides::sample(int lane, const Paths& paths, const Color& color, const Vec2& screen, const Vec2& lens,
                    SampleBlock& out) const {
  const float vertices = paths.vertices[lane], sent = paths.sent[lane];
  out.set(Aov::shading, lane, vertices > 0 ? sent / vertices : sent);
  const auto i = static_cast<std::size_t>(lane);
  for (int c = 0; c < 3; ++c) {
    if (out.has(Aov::histogram))
      out.channel(Aov::histogram, c)[i] = static_cast<float>(histogram_bin(color[c]));
    if (out.has(Aov::box_cox)) out.channel(Aov::box_cox, c)[i] = 2 * (root(color[c]) - 1);
  }
  if (!vectors_) return;
  const auto put = [&](int at, float v) { out.channel(Aov::sample_vectors, at)[i] = v; };
  put(SampleVector::screen, screen.x);
  put(SampleVector::screen + 1, screen.y);
  put(SampleVector::lens, lens.x);
  put(SampleVector::lens + 1, lens.y);
  put(SampleVector::time, paths.lane[i].time);
  vector_part(SampleVector::color, lane, color, out);
}

void Guides::point_samples(const BlockKeys& block, Packet& rays, SampleBlock& out) const {
  std::array<Ray, kLanes> through;
  std::array<Vec2, kLanes> pixels;
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    pixels[i] = {static_cast<float>(block.x + lane % kBlockEdge) + 0.5f,
                 static_cast<float>(block.y + lane / kBlockEdge) + 0.5f};
    through[i] = views_.now.central_ray(pixels[i].x, pixels[i].y, kMiddle);
    rays.set(lane, through[i].origin, through[i].direction, kFar, {kMiddle, RayKind::camera, 0});
  }
  scene_.bvh().intersect_coherent(rays);
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    const Ray& ray = through[i];
    if (rays.hit(lane)) {
      const Hit hit = rays.at(lane);
      const Surface s =
          scene_.geometry().surface(hit, ray.origin, ray.direction, rays.distance(lane), kMiddle);
      point_sample(hit, s, ray, pixels[i], lane, out);
    } else {
      sky_point(ray, pixels[i], lane, out);
    }
  }
}

// The sky is so far away that only the camera's turning moves it.
void Guides::sky_point(const Ray& ray, const Vec2& pixel, int lane, SampleBlock& out) const {
  const auto way_between = [&](const CameraRays& from, const CameraRays& to) {
    if (views_.now.parallel()) return Vec2(0, 0);
    return way(from, from.origin(kMiddle) + ray.direction, to, to.origin(kMiddle) + ray.direction, pixel);
  };
  if (out.has(Aov::motion)) out.set(Aov::motion, lane, way_between(views_.before, views_.now));
  if (out.has(Aov::next_motion)) out.set(Aov::next_motion, lane, way_between(views_.now, views_.after));
  out.set(Aov::previous_depth, lane, kSkyDepth);
  out.set(Aov::next_depth, lane, kSkyDepth);
}

// What is behind a camera is nowhere: as if it came from, or went, outside of any frame. Both ends are
// rounded alike: what rests moves by nothing.
Vec2 Guides::way(const CameraRays& from, const Vec3& there, const CameraRays& to, const Vec3& here,
                 const Vec2& pixel) {
  const std::optional<Vec2> start = from.pixel(there, kMiddle, pixel), end = to.pixel(here, kMiddle, pixel);
  return start && end ? *end - *start : Vec2(kSkyDepth, kSkyDepth);
}

void Guides::point_sample(const Hit& hit, const Surface& s, const Ray& ray, const Vec2& pixel, int lane,
                          SampleBlock& out) const {
  out.set(Aov::geometric_normal, lane, dot(s.ng, ray.direction) > 0 ? -s.ng : s.ng);
  out.set(Aov::object_id, lane, static_cast<float>(scene_.geometry().object(hit) + 1));
  out.set(Aov::material_id, lane, static_cast<float>(s.material + 1));
  if (out.has(Aov::depth_gradient)) out.set(Aov::depth_gradient, lane, depth_gradient(s, pixel));
  if (out.has(Aov::motion) || out.has(Aov::previous_depth)) {
    const Vec3 before = scene_.frames_later(hit, s.position, -1);
    out.set(Aov::motion, lane, way(views_.before, before, views_.now, s.position, pixel));
    out.set(Aov::previous_depth, lane, views_.before.depth(before, kMiddle));
  }
  if (out.has(Aov::next_motion) || out.has(Aov::next_depth)) {
    const Vec3 after = scene_.frames_later(hit, s.position, 1);
    out.set(Aov::next_motion, lane, way(views_.now, s.position, views_.after, after, pixel));
    out.set(Aov::next_depth, lane, views_.after.depth(after, kMiddle));
  }
}

// By the tangent plane, half a pixel to each side. 0 where the plane is seen edge on.
Vec2 Guides::depth_gradient(const Surface& s, const Vec2& pixel) const {
  const auto depth_at = [&](float x, float y, float& depth) {
    const Ray r = views_.now.central_ray(x, y, kMiddle);
    const float along = dot(s.position - r.origin, s.ng) / dot(r.direction, s.ng);
    depth = views_.now.depth(r.origin + r.direction * along, kMiddle);
    return std::isfinite(along) && along > 0;
  };
  float left, right, top, bottom;
  Vec2 slope(0, 0);
  if (depth_at(pixel.x - 0.5f, pixel.y, left) && depth_at(pixel.x + 0.5f, pixel.y, right))
    slope.x = right - left;
  if (depth_at(pixel.x, pixel.y - 0.5f, top) && depth_at(pixel.x, pixel.y + 0.5f, bottom))
    slope.y = bottom - top;
  return slope;
}

}  // namespace tessera::tracer
