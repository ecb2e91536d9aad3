// SPDX-License-Identifier: Apache-2.0
#include "worker/render/light/points.h"

#include "worker/render/warp.h"

namespace tessera::tracer {
namespace {

// 1 - cos of the half angle under which a sphere is seen from outside.
float sphere_versine(float radius2, float distance2) {
  const float sin2 = radius2 / distance2;
  return sin2 / (1.0f + root(1.0f - sin2));
}

// Not inside, nor within rounding on the sphere: from there the cone's near side would be p itself.
bool is_outside(const Sphere& s, float distance2) {
  const float largest = std::max({std::abs(s.center.x), std::abs(s.center.y), std::abs(s.center.z)});
  return distance2 > square(s.radius + 1e-5f * (s.radius + largest));
}

// The point as p sees it, its pdf as if drawn by the area; none if p is on the surface's plane.
MaybePoint seen(const Vec3& p, const Vec3& position, const Vec3& normal, const Vec2& uv, float area) {
  const Vec3 way = position - p;
  const float distance2 = dot(way, way);
  if (!(distance2 > 0)) return {};
  const Vec3 direction = way * (1.0f / std::sqrt(distance2));
  const float cosine = -dot(direction, normal);
  if (!(std::abs(cosine) > 0)) return {};
  return LightPoint{position, normal, uv, direction, cosine, area_pdf(distance2, cosine, area)};
}

// A rectangle as p sees it: p is the origin, the rectangle lies in the plane z = z0 < 0. In doubles, for the
// solid angle is a small difference of large angles.
class SphericalRectangle {
 public:
  SphericalRectangle(const Quad& q, const Vec3& p) {
    const Imath::V3d u(q.edge_u), v(q.edge_v), to(Imath::V3d(q.corner) - Imath::V3d(p));
    const double width = u.length(), height = v.length();
    if (!(width > 0 && height > 0) || std::abs(u.dot(v)) > kSkew * width * height) return;
    const Imath::V3d x = u / width, y = v / height, z = x.cross(y);
    z0_ = -std::abs(to.dot(z));
    x0_ = to.dot(x);
    y0_ = to.dot(y);
    x1_ = x0_ + width;
    y1_ = y0_ + height;
    if (!(-z0_ > kFlat * (width + height))) return;
    const double z2 = z0_ * z0_;
    // The normals' z of the planes through p and the edges; their x or y is the rest.
    b0_ = -y0_ / std::sqrt(y0_ * y0_ + z2);
    b1_ = y1_ / std::sqrt(y1_ * y1_ + z2);
    const double right = x1_ / std::sqrt(x1_ * x1_ + z2), left = -x0_ / std::sqrt(x0_ * x0_ + z2);
    const double g0 = std::acos(-b0_ * right), g1 = std::acos(-right * b1_);
    const double g2 = std::acos(-b1_ * left), g3 = std::acos(-left * b0_);
    k_ = 2 * std::numbers::pi - g2 - g3;
    solid_angle_ = g0 + g1 - k_;
  }

  // Steradians; 0: not to be drawn from.
  double solid_angle() const { return solid_angle_ > kTiny ? solid_angle_ : 0; }

  // As shares of the edges.
  Vec2 sample(const Vec2& u) const {
    const double angle = u.x * solid_angle_ + k_;
    const double f = (std::cos(angle) * b0_ - b1_) / std::sin(angle);
    const double c = std::clamp(std::copysign(1 / std::sqrt(f * f + b0_ * b0_), f), -1.0, 1.0);
    const double x = std::clamp(-(c * z0_) / std::sqrt(std::max(1 - c * c, 1e-30)), x0_, x1_);
    const double d2 = x * x + z0_ * z0_;
    const double h0 = y0_ / std::sqrt(d2 + y0_ * y0_), h1 = y1_ / std::sqrt(d2 + y1_ * y1_);
    const double h = h0 + u.y * (h1 - h0);
    const double y = std::clamp(h * std::sqrt(d2 / std::max(1 - h * h, 1e-30)), y0_, y1_);
    return {static_cast<float>((x - x0_) / (x1_ - x0_)), static_cast<float>((y - y0_) / (y1_ - y0_))};
  }

 private:
  static constexpr double kSkew = 1e-5;  // cosine of the edges up to which they count as square
  static constexpr double kFlat = 1e-6;  // nearer to the plane, in edges, nothing is seen
  static constexpr double kTiny = 1e-5;  // steradians, below which the area is as good and exact

  double x0_ = 0, y0_ = 0, x1_ = 0, y1_ = 0, z0_ = 0, b0_ = 0, b1_ = 0, k_ = 0, solid_angle_ = 0;
};

}  // namespace

MaybePoint sample_triangle(const Triangle& t, const Vec3& p, const Vec2& u) {
  const Vec2 uv = triangle(u);
  const float twice = length(t.normal);
  if (!(twice > 0)) return {};
  const Vec3 at = t.p[0] * (1.0f - uv.x - uv.y) + t.p[1] * uv.x + t.p[2] * uv.y;
  return seen(p, at, t.normal * (1.0f / twice), uv, 0.5f * twice);
}

MaybePoint sample_sphere(const Sphere& sphere, const Vec3& p, const Vec2& u) {
  const Vec3 to_center = sphere.center - p;
  const float distance2 = dot(to_center, to_center), radius2 = square(sphere.radius);
  const bool outside = is_outside(sphere, distance2);
  Vec3 normal;
  if (!outside) {
    normal = cone(u, 2.0f);
  } else {
    const Vec3 d = Frame(unit(to_center)).to_world(cone(u, sphere_versine(radius2, distance2)));
    const float nearest = dot(to_center, d);
    const Vec3 past = d * nearest - to_center;
    normal = unit(past - d * root(radius2 - dot(past, past)));
  }
  MaybePoint point =
      seen(p, sphere.center + normal * sphere.radius, normal, sphere_uv(normal), 4 * kPi * radius2);
  if (point && outside) point->pdf = 1.0f / (2 * kPi * sphere_versine(radius2, distance2));
  return point;
}

float sphere_pdf(const Sphere& sphere, const Vec3& p, float distance2, float cosine) {
  const Vec3 to_center = sphere.center - p;
  const float center2 = dot(to_center, to_center), radius2 = square(sphere.radius);
  if (is_outside(sphere, center2)) return 1.0f / (2 * kPi * sphere_versine(radius2, center2));
  return area_pdf(distance2, cosine, 4 * kPi * radius2);
}

MaybePoint sample_quad(const Quad& quad, const Vec3& p, const Vec2& u) {
  const Vec3 normal = cross(quad.edge_u, quad.edge_v);
  const float area = length(normal);
  if (!(area > 0)) return {};
  const SphericalRectangle rectangle(quad, p);
  const double solid_angle = rectangle.solid_angle();
  const Vec2 uv = solid_angle > 0 ? rectangle.sample(u) : u;
  MaybePoint point =
      seen(p, quad.corner + quad.edge_u * uv.x + quad.edge_v * uv.y, normal * (1.0f / area), uv, area);
  if (point && solid_angle > 0) point->pdf = static_cast<float>(1 / solid_angle);
  return point;
}

float quad_pdf(const Quad& quad, const Vec3& p, float distance2, float cosine) {
  const double solid_angle = SphericalRectangle(quad, p).solid_angle();
  if (solid_angle > 0) return static_cast<float>(1 / solid_angle);
  return area_pdf(distance2, cosine, length(cross(quad.edge_u, quad.edge_v)));
}

MaybePoint sample_disk(const Disk& disk, const Vec3& p, const Vec2& u) {
  const Frame frame(unit(disk.normal));
  const Vec2 d = disc(u);
  const Vec3 at = disk.center + (frame.x * d.x + frame.y * d.y) * disk.radius;
  return seen(p, at, frame.z, (d + Vec2(1, 1)) * 0.5f, kPi * square(disk.radius));
}

float disk_pdf(const Disk& disk, float distance2, float cosine) {
  return area_pdf(distance2, cosine, kPi * square(disk.radius));
}

}  // namespace tessera::tracer
