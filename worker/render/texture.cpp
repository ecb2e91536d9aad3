// SPDX-License-Identifier: Apache-2.0
#include "worker/render/texture.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/scene/import.h"

namespace tessera::tracer {
namespace {

std::vector<bool> pictures_of_materials(const Scene& scene) {
  std::vector<bool> used(scene.pictures.size());
  for (Material m : scene.materials)
    for (const Texture* t : textures_of(m))
      if (*t) used[static_cast<std::size_t>(t->picture)] = true;
  return used;
}

// Within one period, so that floats keep their digits and integers do not overflow, whatever the mesh says.
float reduced(float coordinate, Texture::Wrap wrap) {
  if (!std::isfinite(coordinate)) return 0;
  if (wrap == Texture::Wrap::clamp) return std::clamp(coordinate, 0.0f, 1.0f);
  const float period = wrap == Texture::Wrap::mirror ? 2 : 1;
  return coordinate - period * std::floor(coordinate / period);
}

Texel as_texel(const float* c, int channels) {
  switch (channels) {
    case 1:
      return {c[0], c[0], c[0], 1};
    case 2:
      return {c[0], c[0], c[0], c[1]};
    case 3:
      return {c[0], c[1], c[2], 1};
    default:
      return {c[0], c[1], c[2], c[3]};
  }
}

constexpr float kWhole = 2;  // a footprint over all of a picture

}  // namespace

Textures::Textures(const Scene& scene, std::shared_ptr<TextureCache> cache)
    : cache_(std::move(cache)), pictures_(scene.pictures.size()) {
  const std::vector<bool> used = pictures_of_materials(scene);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    if (!cache_) cache_ = std::make_shared<TextureCache>();
    const Picture& picture = scene.pictures[i];
    for (const Picture& tile : picture.tiles) pictures_[i].push_back({tile.udim, cache_->open(tile)});
    if (picture.tiles.empty()) pictures_[i].push_back({0, cache_->open(picture)});
  }
}

Texel Textures::sample(const TextureCache::Image& image, const Texture& texture,
                       const TextureCache::Footprint& at) const {
  float values[4] = {};
  std::string message;
  if (!cache_->sample(image, texture.wrap_u, texture.wrap_v, at, values, message)) {
    const std::lock_guard lock(mutex_);
    if (!failed_.exchange(true)) failure_ = std::move(message);
    return {0, 0, 0, 0};
  }
  return as_texel(values, image.channels);
}

Texel Textures::lookup(const Texture& texture, const Vec2& uv, float width) const {
  const Tiles& tiles = pictures_[static_cast<std::size_t>(texture.picture)];
  const float footprint = width > 0 ? std::min(width, kWhole) : 0.0f;
  if (tiles.front().udim == 0)
    return sample(tiles.front().image, texture,
                  {reduced(uv.x, texture.wrap_u), reduced(uv.y, texture.wrap_v), footprint});
  const float column = std::floor(uv.x), row = std::floor(1 - uv.y);
  if (!(column >= 0 && column < 10 && row >= 0 && row < 900)) return {0, 0, 0, 0};
  const int udim = 1001 + static_cast<int>(column) + 10 * static_cast<int>(row);
  const auto tile = std::lower_bound(tiles.begin(), tiles.end(), udim,
                                     [](const Tile& t, int number) { return t.udim < number; });
  if (tile == tiles.end() || tile->udim != udim) return {0, 0, 0, 0};
  Texture alone = texture;
  alone.wrap_u = alone.wrap_v = Texture::Wrap::clamp;
  return sample(tile->image, alone, {uv.x - column, uv.y + row, footprint});
}

Color Textures::average(const Texture& texture) const {
  const Tiles& tiles = pictures_[static_cast<std::size_t>(texture.picture)];
  Color sum(0, 0, 0);
  for (const Tile& tile : tiles) {
    const Texel t = sample(tile.image, texture, {0.5f, 0.5f, kWhole});
    sum += Color(t[0], t[1], t[2]);
  }
  return sum / static_cast<float>(tiles.size());
}

void Textures::require_sound() const {
  if (!failed_) return;
  const std::lock_guard lock(mutex_);
  throw Error(ExitCode::internal_error, fmt::format("a texture cannot be read any more: {}", failure_));
}

}  // namespace tessera::tracer
