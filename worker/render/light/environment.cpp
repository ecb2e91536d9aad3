// SPDX-License-Identifier: Apache-2.0
#include "worker/render/light/environment.h"

namespace tessera::tracer {
namespace {

Color pixel(const Picture& p, int x, int y) {
  const float* c = p.pixels.data() + (std::size_t(y) * p.width + x) * p.channels;
  return {c[0], c[p.channels > 2 ? 1 : 0], c[p.channels > 2 ? 2 : 0]};
}

// Between pixel centres; u goes round, v ends at the poles. Both in [0, 1].
Color bilinear(const Picture& p, const Vec2& uv) {
  const float x = uv.x * static_cast<float>(p.width) - 0.5f, y = uv.y * static_cast<float>(p.height) - 0.5f;
  const float left = std::floor(x), top = std::floor(y);
  const int x0 = (std::clamp(static_cast<int>(left), -1, p.width - 1) + p.width) % p.width;
  const int x1 = (x0 + 1) % p.width;
  const int y0 = std::clamp(static_cast<int>(top), 0, p.height - 1);
  const int y1 = std::clamp(static_cast<int>(top + 1), 0, p.height - 1);
  return lerp(lerp(pixel(p, x0, y0), pixel(p, x1, y0), x - left),
              lerp(pixel(p, x0, y1), pixel(p, x1, y1), x - left), y - top);
}

// Integral over pixel (x, y) of the bilinear interpolant: never 0 where the interpolant is not.
Color pixel_mean(const Picture& p, int x, int y) {
  Color sum(0, 0, 0);
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const int sx = (x + dx + p.width) % p.width, sy = std::clamp(y + dy, 0, p.height - 1);
      const float weight = (dx ? 0.125f : 0.75f) * (dy ? 0.125f : 0.75f);
      sum += pixel(p, sx, sy) * weight;
    }
  return sum;
}

}  // namespace

EnvironmentLight::EnvironmentLight(const Scene& scene) : factor_(scene.environment.radiance), mean_(factor_) {
  if (scene.environment.picture < 0) return;
  picture_ = &scene.pictures[static_cast<std::size_t>(scene.environment.picture)];
  cos_ = std::cos(scene.environment.rotation);
  sin_ = std::sin(scene.environment.rotation);
  std::vector<float> row(static_cast<std::size_t>(picture_->width));
  std::vector<float> rows;
  Imath::V3d sum(0, 0, 0);
  double solid_angle = 0;
  for (int y = 0; y < picture_->height; ++y) {
    const double top = std::cos(std::numbers::pi * y / picture_->height);
    const double bottom = std::cos(std::numbers::pi * (y + 1) / picture_->height);
    double brightness = 0;
    for (int x = 0; x < picture_->width; ++x) {
      const Color c = pixel_mean(*picture_, x, y) * factor_;
      sum += Imath::V3d(c.x, c.y, c.z) * (top - bottom);
      row[static_cast<std::size_t>(x)] = luminance(c);
      brightness += luminance(c);
    }
    solid_angle += (top - bottom) * picture_->width;
    rows.push_back(static_cast<float>(brightness * (top - bottom)));
    columns_.emplace_back(row);
  }
  rows_ = Distribution(rows);
  mean_ = Color(float(sum.x / solid_angle), float(sum.y / solid_angle), float(sum.z / solid_angle));
}

Vec2 EnvironmentLight::uv(const Vec3& d) const {
  const float x = cos_ * d.x - sin_ * d.z, z = sin_ * d.x + cos_ * d.z;
  return {0.5f + std::atan2(x, -z) * (0.5f * kInvPi), std::acos(std::clamp(d.y, -1.0f, 1.0f)) * kInvPi};
}

Color EnvironmentLight::radiance(const Vec3& direction) const {
  if (!picture_) return factor_;
  return factor_ * bilinear(*picture_, uv(direction));
}

EnvironmentLight::Direction EnvironmentLight::sample(const Vec2& u) const {
  const Distribution::Pick row = rows_.pick(u.y);
  const Distribution::Pick column = columns_[row.index].pick(u.x);
  const float height = static_cast<float>(picture_->height), width = static_cast<float>(picture_->width);
  const float theta = kPi * (static_cast<float>(row.index) + row.share) / height;
  const float phi = 2 * kPi * ((static_cast<float>(column.index) + column.share) / width - 0.5f);
  const float sine = std::sin(theta);
  const float x = sine * std::sin(phi), z = -sine * std::cos(phi);
  const float density =
      rows_.probability(row.index) * height * columns_[row.index].probability(column.index) * width;
  return {{cos_ * x + sin_ * z, std::cos(theta), cos_ * z - sin_ * x},
          sine > 0 ? density / (2 * kPi * kPi * sine) : 0.0f};
}

float EnvironmentLight::pdf(const Vec3& direction) const {
  const Vec2 at = uv(direction);
  const auto cell = [](float t, int n) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(t * static_cast<float>(n)), 0, n - 1));
  };
  const std::size_t y = cell(at.y, picture_->height), x = cell(at.x, picture_->width);
  const float density = rows_.probability(y) * static_cast<float>(picture_->height) *
                        columns_[y].probability(x) * static_cast<float>(picture_->width);
  const float sine = root(direction.x * direction.x + direction.z * direction.z);
  return sine > 0 ? density / (2 * kPi * kPi * sine) : 0.0f;
}

}  // namespace tessera::tracer
