// SPDX-License-Identifier: Apache-2.0
// The pictures of a scene as materials look them up.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "worker/render/texture_cache.h"
#include "worker/render/vector_math.h"

namespace tessera::tracer {

// Red, green, blue, alpha. Pictures of one or two channels are grey; without an alpha channel alpha is 1.
using Texel = std::array<float, 4>;

// Lookups may come from any thread.
class Textures {
 public:
  // Opens every picture that a material of the scene uses, in `cache` or, if that is null, in one of its own.
  // Keeps no reference to the scene. Throws what TextureCache::open throws.
  explicit Textures(const Scene& scene, std::shared_ptr<TextureCache> cache = nullptr);

  // The mean over a round footprint of diameter `width` about `uv`, both in the picture's texture
  // coordinates; 0: bilinear between the finest texels. (0, 0) is the top left corner. Of UDIM tiles, uv
  // chooses one: columns go right from u = 0, rows go up from v = 1; where there is none everything is 0.
  // The texture must be of a picture that a material of the scene uses.
  Texel lookup(const Texture&, const Vec2& uv, float width) const;

  // Mean colour of its picture.
  Color average(const Texture&) const;

  // Throws Error if a lookup failed since the beginning, as when somebody removes files of the cache. Such a
  // lookup is 0: within a ray's traversal nothing can be thrown.
  void require_sound() const;

 private:
  struct Tile {
    int udim;
    TextureCache::Image image;
  };
  using Tiles = std::vector<Tile>;  // by rising udim; a picture that is no set has one of number 0

  Texel sample(const TextureCache::Image&, const Texture&, const TextureCache::Footprint&) const;

  std::shared_ptr<TextureCache> cache_;  // shared by the scenes of a process; null: no material has a texture
  std::vector<Tiles> pictures_;          // parallel to Scene::pictures
  mutable std::atomic<bool> failed_ = false;
  mutable std::mutex mutex_;     // of what follows
  mutable std::string failure_;  // the first
};

}  // namespace tessera::tracer
