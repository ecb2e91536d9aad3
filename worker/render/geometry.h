// SPDX-License-Identifier: Apache-2.0
// What a ray can hit, as the flat tables that shading reads: pieces of triangles, spheres, quads or disks, in
// world space, at any time that the shutter is open.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "worker/render/motion.h"
#include "worker/render/vector_math.h"

namespace tessera::tracer {

// What is known of the nearest intersection of a ray.
struct Hit {
  std::uint32_t piece;      // index into Geometry::pieces
  std::uint32_t primitive;  // triangle of the mesh, or member of the piece
  float u, v;  // of a triangle: barycentric, of its second and third corner; of a quad: along its edges
};

// The rays that may see a thing, as bits; those of Object.
enum class RayKind : std::uint8_t { camera, scattered, shadow };
inline constexpr std::uint8_t bit(RayKind k) { return static_cast<std::uint8_t>(1 << static_cast<int>(k)); }
inline constexpr std::uint8_t kSeenByAll = 7;

// Bits of RayKind; those of no object: all.
std::uint8_t seen_by(const Scene& scene, int object);

// The corners of a triangle.
using Corners = std::array<Vec3, 3>;

// A mesh in the world, or shapes of one kind that the same rays see.
struct Piece {
  enum class Kind : std::uint8_t { mesh, spheres, quads, disks };
  Kind kind = Kind::mesh;
  std::uint8_t seen_by = kSeenByAll;  // bits of RayKind
  bool placed = false;                // false: to_world is the identity, at any time
  const Corners* corners = nullptr;   // of the triangles of a mesh that is not placed, if they are kept
  int track = -1;                     // index into Scene::tracks
  int light = -1;            // of a mesh that emits: index into Lights, of the mesh or of its first triangle
  int light_step = 0;        // 1: each triangle is a light of its own
  std::uint32_t shapes = 0;  // index into Geometry::members
};

// A point on a surface, in world space, as the importer described it.
struct Surface {
  Vec3 position;
  Vec3 ng;  // unit geometric normal, on the front
  Vec3 ns;  // unit interpolated normal
  Vec2 uv{0, 0}, uv2{0, 0};
  int material = 0;
  int light = -1;               // index into Lights, if the surface emits
  float area = 0;               // of a triangle that emits
  std::uint32_t primitive = 0;  // of a mesh that emits: the triangle
  float time = 0;               // share of the shutter
  float cone = 0;               // diameter of what the ray stands for, metres; 0: a point
};

// A triangle in the world.
struct Triangle {
  Corners p;
  Vec3 normal;  // on the front; its length is twice the area
};

// Times are shares of the shutter, 0 to 1. What moves is linear in time, matrix by matrix, between steps that
// are close enough together for its rotation; everything here, and the rays' hits, follow the same steps.
class Geometry {
 public:
  // `scene` is borrowed and must outlive this. One piece an instance, in their order, then the shapes.
  explicit Geometry(const Scene& scene, Shutter shutter = {});
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;

  const Scene& scene() const { return *scene_; }
  std::size_t meshes() const { return scene_->instances.size(); }  // pieces that are meshes: the first ones
  const Mesh& mesh(std::uint32_t piece) const {
    return scene_->meshes[static_cast<std::size_t>(scene_->instances[piece].mesh)];
  }

  // Null: what is hit is no mesh.
  const Mesh* mesh_at(const Hit& hit) const {
    return pieces[hit.piece].kind == Piece::Kind::mesh ? &mesh(hit.piece) : nullptr;
  }

  // The corners of a triangle that stands in the world as its mesh has it and emits nothing: surface_at() is
  // to be asked then, with what they are, for many at once. Null: surface() is.
  const Corners* corners(const Hit& hit) const {
    const Piece& piece = pieces[hit.piece];
    return piece.corners && piece.light < 0 ? piece.corners + hit.primitive : nullptr;
  }
  // Asks memory for what surface() or surface_at() will read first.
  // Inlined by force: GCC 12 takes a function that only prefetches for one without effect, and drops calls to
  // it.
  [[gnu::always_inline]] void prefetch(const Hit& hit) const {
    const Piece& piece = pieces[hit.piece];
    if (piece.kind != Piece::Kind::mesh) return;
    const Mesh& of = mesh(hit.piece);
    if (piece.corners) {
      const Corners* at = piece.corners + hit.primitive;
      __builtin_prefetch(at);
      __builtin_prefetch(&(*at)[2].z);
    }
    if (!piece.corners || !of.normals.empty() || !of.uvs.empty())
      __builtin_prefetch(&of.triangles[hit.primitive]);
  }
  // For what is read by index: once the first prefetch may have come.
  [[gnu::always_inline]] void prefetch_corners(const Hit& hit) const {
    const Piece& piece = pieces[hit.piece];
    if (piece.kind != Piece::Kind::mesh) return;
    const Mesh& of = mesh(hit.piece);
    if (piece.corners && of.normals.empty() && of.uvs.empty()) return;
    for (const std::uint32_t corner : of.triangles[hit.primitive]) {
      if (!piece.corners) __builtin_prefetch(&of.positions[corner]);
      if (!of.normals.empty()) __builtin_prefetch(&of.normals[corner]);
      if (!of.uvs.empty()) __builtin_prefetch(&of.uvs[corner]);
    }
  }

  // What a ray from `origin` hits. Precondition: the hit is one of `distance` along `direction` at `time`.
  Surface surface(const Hit& hit, const Vec3& origin, const Vec3& direction, float distance,
                  float time = 0) const;
  // The same where the point and its unit geometric normal are known. Precondition: corners(hit).
  void surface_at(const Hit& hit, const Vec3& position, const Vec3& ng, float time, Surface& s) const;
  int material(const Hit& hit) const;
  int object(const Hit& hit) const;  // index into Scene::objects or -1
  // Of a shape: index into Scene::spheres, quads or disks.
  std::uint32_t shape(const Hit& hit) const { return members[pieces[hit.piece].shapes][hit.primitive]; }

  Triangle triangle(std::uint32_t piece, std::uint32_t primitive, float time = 0) const;
  // Where a mesh stands.
  Matrix to_world(std::uint32_t piece, float time) const;
  Matrix to_world_at(std::uint32_t piece, double seconds) const;  // at any time, also outside the shutter
  // How often and where a piece on a track stands at equal steps of the shutter, its first and last moment
  // included; 1: it does not move.
  std::size_t steps(std::uint32_t piece) const;
  Matrix step(std::uint32_t piece, std::size_t i) const;

  // Texture coordinates of a hit; (0, 0) if the mesh has none. Of spheres and disks: the hit's u and v.
  Vec2 uv(const Hit& hit) const;
  // The same of the second set; of the first if the mesh has no second.
  Vec2 uv2(const Hit& hit) const;
  // Of a point on a sphere or disk.
  Vec2 shape_uv(const Hit& hit, const Vec3& point) const;
  // The direction in which a texture's u grows on the surface, and the one in which its v falls, its set and
  // its transform heeded; not orthogonal, not unit. False where the surface has no usable texture
  // coordinates.
  bool tangents(const Hit& hit, const Texture& texture, Vec3& along_u, Vec3& up, float time = 0) const;

  std::vector<Piece> pieces;
  std::vector<std::vector<std::uint32_t>> members;  // of each piece of shapes: indices into the scene's list
  // Index into Lights or -1, parallel to Scene::spheres, quads and disks.
  std::vector<int> sphere_lights, quad_lights, disk_lights;

 private:
  void keep_corners();
  void add_shapes();
  Surface sphere_surface(const Hit& hit, const Vec3& point) const;
  Surface quad_surface(const Hit& hit) const;
  Surface disk_surface(const Hit& hit, const Vec3& point) const;

  struct Motion {
    Movement movement;
    std::vector<Matrix> steps;
  };
  const Scene* scene_;
  std::vector<Motion> motions_;                // parallel to Scene::tracks
  std::vector<std::vector<Corners>> corners_;  // parallel to Scene::meshes; empty: not kept
};

// Points as p * M.
inline Vec3 moved(const Vec3& p, const Matrix& m) {
  return {p.x * m[0][0] + p.y * m[1][0] + p.z * m[2][0] + m[3][0],
          p.x * m[0][1] + p.y * m[1][1] + p.z * m[2][1] + m[3][1],
          p.x * m[0][2] + p.y * m[1][2] + p.z * m[2][2] + m[3][2]};
}

// Texture coordinates of a sphere at its unit normal: longitude and latitude, as of an environment.
Vec2 sphere_uv(const Vec3& normal);

// Of a disk, at a point of its plane: (0, 0) to (1, 1) is the square around it, along Frame(normal).
Vec2 disk_uv(const Disk& disk, const Vec3& point);

// A ray origin just off the surface, on the side to which `normal` points; Waechter and Binder 2019, "A Fast
// and Robust Method for Avoiding Self-Intersection".
Vec3 offset_origin(const Vec3& p, const Vec3& normal);

}  // namespace tessera::tracer
