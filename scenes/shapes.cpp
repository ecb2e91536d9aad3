// SPDX-License-Identifier: Apache-2.0
#include "scenes/shapes.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>

namespace tessera::scenes {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

void add_quad(Shape& shape, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  shape.triangles.push_back({a, b, c});
  shape.triangles.push_back({a, c, d});
}

void add_face(Shape& shape, const Vec3& corner, const Vec3& u, const Vec3& v) {
  shape.add(sheet(corner, u, v));
}

}  // namespace

void Shape::add(const Shape& other, const Matrix& transform) {
  const auto first = static_cast<std::uint32_t>(positions.size());
  const Matrix directions = transform.inverse().transposed();
  for (const Vec3& p : other.positions) positions.push_back(p * transform);
  for (const Vec3& n : other.normals) {
    Vec3 turned;
    directions.multDirMatrix(n, turned);
    normals.push_back(turned.normalized());
  }
  uvs.insert(uvs.end(), other.uvs.begin(), other.uvs.end());
  for (const auto& t : other.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

// Numerical Recipes' linear congruential generator; its high bits.
float Dice::between(float low, float high) {
  state_ = state_ * 1664525u + 1013904223u;
  return low + (high - low) * static_cast<float>(state_ >> 8) / 16777216.0f;
}

Shape sheet(const Vec3& corner, const Vec3& u, const Vec3& v) {
  const Vec3 normal = u.cross(v).normalized();
  const float w = u.length(), h = v.length();
  Shape shape;
  shape.positions = {corner, corner + u, corner + u + v, corner + v};
  shape.normals.assign(4, normal);
  shape.uvs = {{0, 0}, {w, 0}, {w, h}, {0, h}};
  add_quad(shape, 0, 1, 2, 3);
  return shape;
}

Shape box(const Vec3& low, const Vec3& high) {
  const Vec3 s = high - low, x(s.x, 0, 0), y(0, s.y, 0), z(0, 0, s.z);
  Shape shape;
  add_face(shape, low, z, y);
  add_face(shape, high, -y, -z);
  add_face(shape, low, x, z);
  add_face(shape, low + y, z, x);
  add_face(shape, low, y, x);
  add_face(shape, low + z, x, y);
  return shape;
}

Shape lathe(const std::vector<Vec2>& profile, int segments) {
  Shape shape;
  const auto columns = static_cast<std::uint32_t>(segments + 1);
  for (std::size_t r = 0; r < profile.size(); ++r) {
    const Vec2 before = r > 0 && profile[r - 1] != profile[r] ? profile[r] - profile[r - 1] : Vec2(0),
               after = r + 1 < profile.size() && profile[r + 1] != profile[r] ? profile[r + 1] - profile[r]
                                                                              : Vec2(0);
    const Vec2 along = before.normalized() + after.normalized();
    for (std::uint32_t s = 0; s < columns; ++s) {
      const float angle = 2 * kPi * static_cast<float>(s) / static_cast<float>(segments);
      const float x = std::cos(angle), z = -std::sin(angle);
      shape.positions.emplace_back(profile[r].x * x, profile[r].y, profile[r].x * z);
      shape.normals.push_back(Vec3(along.y * x, -along.x, along.y * z).normalized());
      shape.uvs.emplace_back(static_cast<float>(s) / static_cast<float>(segments), -profile[r].y);
    }
  }
  for (std::uint32_t r = 0; r + 1 < profile.size(); ++r) {
    if (profile[r] == profile[r + 1]) continue;
    for (std::uint32_t s = 0; s + 1 < columns; ++s) {
      const std::uint32_t a = r * columns + s, b = a + columns;
      if (profile[r].x > 0) shape.triangles.push_back({a, a + 1, b + 1});
      if (profile[r + 1].x > 0) shape.triangles.push_back({a, b + 1, b});
    }
  }
  return shape;
}

Shape ball(float radius, int segments) {
  std::vector<Vec2> profile;
  for (int i = 0; i <= segments / 2; ++i) {
    const float angle = kPi * (2 * static_cast<float>(i) / static_cast<float>(segments) - 0.5f);
    profile.emplace_back(radius * std::max(std::cos(angle), 0.0f), radius * std::sin(angle));
  }
  return lathe(profile, segments);
}

Shape arch(float width, float opening, float height, float depth, int segments) {
  Shape shape;
  const float r = opening / 2, half = width / 2, z = depth / 2;
  for (int s = 0; s < segments; ++s) {
    const float a = kPi * static_cast<float>(s) / static_cast<float>(segments),
                b = kPi * static_cast<float>(s + 1) / static_cast<float>(segments);
    const Vec3 p(r * std::cos(a), r * std::sin(a), z), q(r * std::cos(b), r * std::sin(b), z);
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    for (const float side : {1.0f, -1.0f})
      for (const Vec3& v : {p, Vec3(p.x, height, z), Vec3(q.x, height, z), q}) {
        shape.positions.emplace_back(v.x, v.y, side * z);
        shape.normals.emplace_back(0, 0, side);
        shape.uvs.emplace_back(v.x, -v.y);
      }
    add_quad(shape, first, first + 1, first + 2, first + 3);
    add_quad(shape, first + 7, first + 6, first + 5, first + 4);
    const auto soffit = static_cast<std::uint32_t>(shape.positions.size());
    for (const Vec3& v : {p, q, Vec3(q.x, q.y, -z), Vec3(p.x, p.y, -z)}) {
      shape.positions.push_back(v);
      shape.normals.push_back(-Vec3(v.x, v.y, 0).normalized());
      shape.uvs.emplace_back(v.x, v.z);
    }
    add_quad(shape, soffit, soffit + 1, soffit + 2, soffit + 3);
  }
  shape.add(box({-half, 0, -z}, {-r, height, z}));
  shape.add(box({r, 0, -z}, {half, height, z}));
  return shape;
}

Shape leaf(float length, float width, float bend) {
  constexpr int kSteps = 5;
  Shape shape;
  for (int i = 0; i <= kSteps; ++i) {
    const float t = static_cast<float>(i) / kSteps;
    const float half = 0.5f * width * std::sin(kPi * std::pow(t, 0.7f)) + 0.02f * width;
    const Vec3 spine(0, length * (0.25f * t - bend * t * t), length * t);
    const float rise = 0.35f * half;  // folded along the spine
    for (const Vec3& offset : {Vec3(-half, rise, 0), Vec3(0, 0, 0), Vec3(half, rise, 0)}) {
      shape.positions.push_back(spine + offset);
      shape.normals.push_back(
          Vec3(-0.5f * offset.x / std::max(half, 1e-4f), 1, -0.25f + 2 * bend * t).normalized());
      shape.uvs.emplace_back(offset.x, t);
    }
  }
  for (std::uint32_t i = 0; i < kSteps; ++i)
    for (std::uint32_t s = 0; s < 2; ++s)
      add_quad(shape, 3 * i + s, 3 * i + 3 + s, 3 * i + 4 + s, 3 * i + 1 + s);
  return shape;
}

Shape foliage(const Vec3& radii, int count, float leaf_length, std::uint32_t seed) {
  Shape shape;
  Dice dice(seed);
  for (int i = 0; i < count; ++i) {
    const float y = dice.between(-1, 1), around = dice.between(0, 2 * kPi), flat = std::sqrt(1 - y * y);
    const Vec3 out(flat * std::cos(around), y, flat * std::sin(around));
    const float inward = 1 - 0.45f * std::pow(dice.between(0, 1), 2.0f);
    const Vec3 root = Vec3(out.x * radii.x, out.y * radii.y, out.z * radii.z) * inward;
    const float size = leaf_length * dice.between(0.7f, 1.3f);
    const Vec3 way =
        (out + Vec3(dice.between(-0.6f, 0.6f), dice.between(-0.3f, 0.7f), dice.between(-0.6f, 0.6f)))
            .normalized();
    const Vec3 side = Vec3(0, 1, 0.01f).cross(way).normalized(), up = way.cross(side);
    const Matrix place(side.x, side.y, side.z, 0, up.x, up.y, up.z, 0, way.x, way.y, way.z, 0, root.x, root.y,
                       root.z, 1);
    shape.add(leaf(size, 0.42f * size, dice.between(0.2f, 0.6f)), place);
  }
  return shape;
}

void write_obj(const Shape& shape, const std::filesystem::path& file) {
  std::ofstream out(file);
  for (const Vec3& p : shape.positions) out << fmt::format("v {:.5f} {:.5f} {:.5f}\n", p.x, p.y, p.z);
  for (const Vec2& t : shape.uvs) out << fmt::format("vt {:.5f} {:.5f}\n", t.x, 1 - t.y);
  for (const Vec3& n : shape.normals) out << fmt::format("vn {:.4f} {:.4f} {:.4f}\n", n.x, n.y, n.z);
  for (const auto& t : shape.triangles)
    out << fmt::format("f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", t[0] + 1, t[1] + 1, t[2] + 1);
}

}  // namespace tessera::scenes
