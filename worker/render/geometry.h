// SPDX-License-Identifier: Apache-2.0
// What a ray can hit, as the flat tables that shading reads: pieces of triangles or spheres, in world space.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "worker/render/vector_math.h"

namespace tessera::tracer {

// What is known of the nearest intersection of a ray.
struct Hit {
  std::uint32_t piece;      // index into Geometry::pieces
  std::uint32_t primitive;  // triangle or sphere
  float u, v;               // barycentric, of the triangle's second and third corner
};

// The rays that may see a thing, as bits; those of Object.
enum class RayKind : std::uint8_t { camera, scattered, shadow };

// A mesh in the world, or (with `mesh` null) all spheres of the scene.
struct Piece {
  const Mesh* mesh = nullptr;
  Matrix to_world;         // points, as p * M
  Matrix normal_to_world;  // inverse transpose: keeps what is outside outside, also in a mirror
  bool placed = false;     // false: to_world is the identity
  int light = -1;          // of a mesh that emits; index into Lights
};

// A point on a surface, in world space, as the importer described it.
struct Surface {
  Vec3 position;
  Vec3 ng;  // unit geometric normal, on the front
  Vec3 ns;  // unit interpolated normal
  Vec2 uv{0, 0}, uv2{0, 0};
  int material = 0;
  int light = -1;  // index into Lights, if the surface emits
  float cone = 0;  // diameter of what the ray stands for, metres; 0: a point
};

// The corners of a triangle in the world.
struct Triangle {
  std::array<Vec3, 3> p;
  Vec3 normal;  // on the front; its length is twice the area
};

class Geometry {
 public:
  // `scene` is borrowed and must outlive this. One piece an instance, in their order, then the spheres.
  explicit Geometry(const Scene& scene);

  const Scene& scene() const { return *scene_; }
  std::size_t sphere_piece() const { return pieces.size() - 1; }

  Surface surface(const Hit& hit, const Vec3& origin, const Vec3& direction, float distance,
                  float time = 0) const;
  int object(const Hit& hit) const {
    return pieces[hit.piece].mesh ? scene_->instances[hit.piece].object
                                  : scene_->spheres[hit.primitive].object;
  }
  Matrix to_world(std::uint32_t piece, float) const { return pieces[piece].to_world; }
  Matrix to_world_at(std::uint32_t piece, double) const { return pieces[piece].to_world; }
  std::size_t steps(std::uint32_t) const { return 1; }
  int material(const Hit& hit) const {
    const Mesh* mesh = pieces[hit.piece].mesh;
    return mesh ? mesh->material : scene_->spheres[hit.primitive].material;
  }
  Triangle triangle(std::uint32_t piece, std::uint32_t primitive) const;
  // A point of the piece's mesh, in the world.
  Vec3 to_world(std::uint32_t piece, const Vec3& point) const;
  // Texture coordinates at a barycentric point; (0, 0) if the mesh has none.
  Vec2 uv(const Hit& hit) const;
  // The same of the second set; of the first if the mesh has no second.
  Vec2 uv2(const Hit& hit) const;
  // The direction in which the texture's u grows, and the one in which its v falls; not orthogonal, not unit.
  // False where the triangle has no usable texture coordinates.
  bool tangents(const Hit& hit, const Texture& texture, Vec3& along_u, Vec3& up) const;

  std::vector<Piece> pieces;
  std::vector<int> sphere_lights;  // index into Lights or -1, parallel to Scene::spheres

 private:
  Surface sphere_surface(const Hit& hit, const Vec3& point) const;

  const Scene* scene_;
};

// Texture coordinates of a sphere at its unit normal: longitude and latitude, as of an environment.
Vec2 sphere_uv(const Vec3& normal);

// A ray origin just off the surface, on the side to which `normal` points; Waechter and Binder 2019, "A Fast
// and Robust Method for Avoiding Self-Intersection".
Vec3 offset_origin(const Vec3& p, const Vec3& normal);

}  // namespace tessera::tracer
