// SPDX-License-Identifier: Apache-2.0
#include "worker/render/camera.h"

#include "core/scene/track.h"
#include "worker/render/warp.h"

namespace tessera::tracer {
namespace {

constexpr int kCameraSteps = 17;  // of a moving camera while the shutter is open

Vec3 axis(const Matrix& m, int row) { return unit({m[row][0], m[row][1], m[row][2]}); }

std::vector<Vec2> polygon(int blades, float rotation) {
  std::vector<Vec2> corners;
  if (blades < 3) return corners;
  for (int i = 0; i < blades; ++i) {
    const float angle = rotation + 2 * kPi * static_cast<float>(i) / static_cast<float>(blades);
    corners.emplace_back(std::cos(angle), std::sin(angle));
  }
  return corners;
}

}  // namespace

CameraRays::CameraRays(const Scene& scene, const Camera& camera, const Size& frame, double open, double close)
    : projection_(camera.projection),
      frame_(static_cast<float>(frame.width), static_cast<float>(frame.height)),
      lens_radius_(camera.projection == Camera::Projection::panorama ? 0 : camera.lens_radius),
      focus_distance_(camera.focus_distance),
      corners_(polygon(camera.blades, camera.blade_rotation)) {
  const int steps = camera.track < 0 ? 1 : open == close ? 1 : kCameraSteps;
  for (int i = 0; i < steps; ++i) {
    const double seconds = open + (close - open) * i / std::max(1, steps - 1);
    const Matrix m =
        camera.track < 0
            ? camera.to_world
            : camera.to_world * pose(scene.tracks[static_cast<std::size_t>(camera.track)], seconds);
    steps_.push_back({{m[3][0], m[3][1], m[3][2]}, axis(m, 0), axis(m, 1), -axis(m, 2)});
  }
  float pixel;
  if (projection_ == Camera::Projection::orthographic)
    pixel = camera.width > 0 ? camera.width / frame_.x : camera.height / frame_.y;
  else if (projection_ == Camera::Projection::panorama)
    pixel = kPi / frame_.y;
  else
    pixel = camera.horizontal_fov > 0 ? 2 * std::tan(camera.horizontal_fov / 2) / frame_.x
                                      : 2 * std::tan(camera.vertical_fov / 2) / frame_.y;
  scale_ = {pixel, -pixel};
  shift_ = {-0.5f * frame_.x * pixel, 0.5f * frame_.y * pixel};
  (projection_ == Camera::Projection::orthographic ? footprint_ : spread_) = pixel;
}

CameraRays::Axes CameraRays::blended(const Axes& a, const Axes& b, float t) {
  const auto between = [&](const Vec3& p, const Vec3& q) { return p * (1 - t) + q * t; };
  return {between(a.origin, b.origin), unit(between(a.right, b.right)), unit(between(a.up, b.up)),
          unit(between(a.forward, b.forward))};
}

CameraRays::Axes CameraRays::axes(float time) const {
  const float at = time * static_cast<float>(steps_.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), steps_.size() - 2);
  return blended(steps_[i], steps_[i + 1], at - static_cast<float>(i));
}

// Uniform on the aperture, whose corners lie on the unit circle.
Vec2 CameraRays::on_lens(const Vec2& u) const {
  if (corners_.empty()) return disc(u);
  const float at = u.x * static_cast<float>(corners_.size());
  const auto i = std::min(static_cast<std::size_t>(at), corners_.size() - 1);
  const Vec2 uv = triangle({at - static_cast<float>(i), u.y});
  return corners_[i] * uv.x + corners_[(i + 1) % corners_.size()] * uv.y;
}

Ray CameraRays::ray(float x, float y, const Vec2& lens, float time) const {
  if (lens_radius_ <= 0) return central_ray(x, y, time);
  const Axes a = steps_.size() == 1 ? steps_[0] : axes(time);
  const Vec3 aside = a.right * (x * scale_.x + shift_.x) + a.up * (y * scale_.y + shift_.y);
  const Vec2 d = on_lens(lens) * lens_radius_;
  const Vec3 start = a.right * d.x + a.up * d.y;
  if (projection_ == Camera::Projection::orthographic)
    return {a.origin + aside + start, unit(a.forward * focus_distance_ - start)};
  return {a.origin + start, unit((a.forward + aside) * focus_distance_ - start)};
}

WideRay CameraRays::pinhole_rays(const Wide2& pixels) const {
  const Axes& a = steps_[0];
  const Wide x = pixels.x * scale_.x + shift_.x, y = pixels.y * scale_.y + shift_.y;
  const Wide3 way = wide(a.forward) + wide(a.right) * x + wide(a.up) * y;
  return {wide(a.origin), way * (1.0f / root(dot(way, way)))};
}

Ray CameraRays::central_ray(float x, float y, float time) const {
  const Axes a = steps_.size() == 1 ? steps_[0] : axes(time);
  if (projection_ == Camera::Projection::panorama) {
    const float phi = 2 * kPi * (x / frame_.x - 0.5f), theta = kPi * y / frame_.y;
    const float sine = std::sin(theta);
    return {a.origin, unit(a.right * (sine * std::sin(phi)) + a.up * std::cos(theta) +
                           a.forward * (sine * std::cos(phi)))};
  }
  const Vec3 aside = a.right * (x * scale_.x + shift_.x) + a.up * (y * scale_.y + shift_.y);
  if (projection_ == Camera::Projection::orthographic) return {a.origin + aside, a.forward};
  return {a.origin, unit(a.forward + aside)};
}

float CameraRays::depth(const Vec3& point, float time) const {
  const Axes a = steps_.size() == 1 ? steps_[0] : axes(time);
  const Vec3 way = point - a.origin;
  return projection_ == Camera::Projection::panorama ? length(way) : dot(way, a.forward);
}

std::optional<Vec2> CameraRays::pixel(const Vec3& point, float time, const Vec2& near) const {
  const Axes a = steps_.size() == 1 ? steps_[0] : axes(time);
  const Vec3 way = point - a.origin;
  const float x = dot(way, a.right), y = dot(way, a.up), z = dot(way, a.forward);
  if (projection_ == Camera::Projection::panorama) {
    const float far = length(way);
    if (!(far > 0)) return std::nullopt;
    float u = (std::atan2(x, z) / (2 * kPi) + 0.5f) * frame_.x;
    u += frame_.x * std::round((near.x - u) / frame_.x);
    return Vec2(u, std::acos(std::clamp(y / far, -1.0f, 1.0f)) * kInvPi * frame_.y);
  }
  if (projection_ == Camera::Projection::orthographic)
    return Vec2((x - shift_.x) / scale_.x, (y - shift_.y) / scale_.y);
  if (!(z > 0)) return std::nullopt;
  return Vec2((x / z - shift_.x) / scale_.x, (y / z - shift_.y) / scale_.y);
}

}  // namespace tessera::tracer
