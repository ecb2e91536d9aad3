// SPDX-License-Identifier: Apache-2.0
// What a BVH is built of, as a digest; and the last few, by it.
#include <type_traits>
#include <vector>

#include "worker/latest_cache.h"
#include "worker/render/bvh.h"
#include "worker/render/render.h"

namespace tessera::tracer {
namespace {

class Hashing {
 public:
  explicit Hashing(const Geometry& geometry) : geometry_(geometry), scene_(geometry.scene()) {}

  // Each mesh once, though it may be there many times.
  void meshes() {
    for (const Mesh& mesh : scene_.meshes) {
      many(mesh.positions);
      many(mesh.triangles);
    }
  }

  void piece(std::uint32_t index, const std::function<bool(int)>& masked) {
    const Piece& p = geometry_.pieces[index];
    one(p.kind);
    one(p.seen_by);
    if (p.kind != Piece::Kind::mesh) return shapes(index, masked);
    one(scene_.instances[index].mesh);
    one(p.placed);
    one(masked(geometry_.mesh(index).material));
    one(geometry_.steps(index));
    for (std::size_t step = 0; step < geometry_.steps(index); ++step) one(geometry_.step(index, step));
  }

  Digest digest() { return hash_.hex(); }

 private:
  template <class T>
  void one(const T& value) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_same_v<T, Matrix> ||
                  std::is_same_v<T, Vec3> || std::is_same_v<T, float>);
    hash_.add(&value, sizeof value);
  }
  template <class T>
  void many(const std::vector<T>& values) {
    one(values.size());
    hash_.add(values.data(), values.size() * sizeof(T));
  }

  void shapes(std::uint32_t index, const std::function<bool(int)>& masked) {
    const Piece& p = geometry_.pieces[index];
    const auto& members = geometry_.members[p.shapes];
    one(members.size());
    for (std::uint32_t i = 0; i < members.size(); ++i) {
      one(masked(geometry_.material({index, i, 0, 0})));
      shape(p.kind, members[i]);
    }
  }
  void shape(Piece::Kind kind, std::uint32_t member) {
    if (kind == Piece::Kind::spheres) {
      one(scene_.spheres[member].center);
      one(scene_.spheres[member].radius);
    } else if (kind == Piece::Kind::quads) {
      one(scene_.quads[member].corner);
      one(scene_.quads[member].edge_u);
      one(scene_.quads[member].edge_v);
    } else {
      one(scene_.disks[member].center);
      one(scene_.disks[member].normal);
      one(scene_.disks[member].radius);
    }
  }

  const Geometry& geometry_;
  const Scene& scene_;
  Sha256 hash_;
};

}  // namespace

Digest core_key(const Geometry& geometry, const std::function<bool(int)>& masked) {
  Hashing hashing(geometry);
  hashing.meshes();
  for (std::uint32_t i = 0; i < geometry.pieces.size(); ++i) hashing.piece(i, masked);
  return hashing.digest();
}

CoreSource kept_cores(std::size_t most) {
  const auto kept = std::make_shared<LatestCache<BvhCore>>(most);
  return [kept](const Geometry& geometry, const std::function<bool(int)>& masked) {
    return kept->find_or_make(core_key(geometry, masked),
                              [&] { return std::make_shared<const BvhCore>(geometry, masked); });
  };
}

}  // namespace tessera::tracer
