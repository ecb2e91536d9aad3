// SPDX-License-Identifier: Apache-2.0
#include "worker/render/camera.h"

#include "worker/render/warp.h"

namespace tessera::tracer {
namespace {

Vec3 axis(const Matrix& m, int row) { return unit({m[row][0], m[row][1], m[row][2]}); }

}  // namespace

CameraRays::CameraRays(const Camera& camera, const Size& frame)
    : origin_(camera.to_world[3][0], camera.to_world[3][1], camera.to_world[3][2]),
      right_(axis(camera.to_world, 0)),
      up_(axis(camera.to_world, 1)),
      forward_(-axis(camera.to_world, 2)),
      lens_radius_(camera.lens_radius),
      focus_distance_(camera.focus_distance) {
  const auto width = static_cast<float>(frame.width), height = static_cast<float>(frame.height);
  const float pixel = camera.horizontal_fov > 0 ? 2 * std::tan(camera.horizontal_fov / 2) / width
                                                : 2 * std::tan(camera.vertical_fov / 2) / height;
  scale_ = {pixel, -pixel};
  shift_ = {-0.5f * width * pixel, 0.5f * height * pixel};
}

Ray CameraRays::ray(float x, float y, const Vec2& lens) const {
  const Vec3 through = forward_ + right_ * (x * scale_.x + shift_.x) + up_ * (y * scale_.y + shift_.y);
  if (lens_radius_ <= 0) return {origin_, unit(through)};
  const Vec2 d = disc(lens) * lens_radius_;
  const Vec3 start = right_ * d.x + up_ * d.y;
  return {origin_ + start, unit(through * focus_distance_ - start)};
}

}  // namespace tessera::tracer
