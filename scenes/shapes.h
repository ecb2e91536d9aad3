// SPDX-License-Identifier: Apache-2.0
// Shapes that scenes are made of: lathed profiles, boxes, arches, leaves. In metres, +Y up.
#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tessera::scenes {

using Vec2 = Imath::V2f;
using Vec3 = Imath::V3f;
using Matrix = Imath::M44f;

// Triangles with texture coordinates, (0, 0) at the top left of a texture; normals may be missing (flat).
struct Shape {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uvs;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  void add(const Shape& other, const Matrix& transform = {});
};

// Numbers that look random and are the same everywhere.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : state_(seed) {}
  float between(float low, float high);

 private:
  std::uint32_t state_;
};

// A flat parallelogram at `corner`; texture coordinates in metres.
Shape sheet(const Vec3& corner, const Vec3& u, const Vec3& v);
Shape box(const Vec3& low, const Vec3& high);

// `profile` as (radius, height), turned about the Y axis in `segments`; smooth, sharp where a point is
// doubled.
Shape lathe(const std::vector<Vec2>& profile, int segments);
Shape ball(float radius, int segments);

// A piece of wall of `width` from the springing of a round arch (y = 0) up to `height`, `depth` thick,
// centred.
Shape arch(float width, float opening, float height, float depth, int segments);

// One pointed leaf along +Z, bent down; its root is the origin.
Shape leaf(float length, float width, float bend);

// `count` leaves on a ball squeezed to `radii`, pointing outward and up.
Shape foliage(const Vec3& radii, int count, float leaf_length, std::uint32_t seed);

void write_obj(const Shape& shape, const std::filesystem::path& file);

}  // namespace tessera::scenes
