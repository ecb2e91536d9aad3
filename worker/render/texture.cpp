// SPDX-License-Identifier: Apache-2.0
#include "worker/render/texture.h"

namespace tessera::tracer {
namespace {

// The pixel that coordinate `i` falls on.
int wrapped(int i, int size, Texture::Wrap wrap) {
  if (wrap == Texture::Wrap::clamp) return std::clamp(i, 0, size - 1);
  const int period = wrap == Texture::Wrap::mirror ? 2 * size : size;
  i %= period;
  if (i < 0) i += period;
  return i < size ? i : period - 1 - i;
}

Texel texel(const Picture& p, int x, int y) {
  const float* c = p.pixels.data() + (std::size_t(y) * p.width + x) * p.channels;
  switch (p.channels) {
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

// The pixel left of (or above) a coordinate, the one after it, and how far between them it lies.
struct Between {
  int first, second;
  float share;
};
Between between(float coordinate, int size, Texture::Wrap wrap) {
  // Wrapping the coordinate first keeps the integers small, whatever the mesh says.
  if (wrap == Texture::Wrap::clamp) coordinate = std::clamp(coordinate, 0.0f, 1.0f);
  if (wrap == Texture::Wrap::repeat) coordinate -= std::floor(coordinate);
  if (wrap == Texture::Wrap::mirror) coordinate -= 2 * std::floor(coordinate / 2);
  if (!std::isfinite(coordinate)) coordinate = 0;
  const float at = coordinate * static_cast<float>(size) - 0.5f;
  const float low = std::floor(at);
  const int i = static_cast<int>(low);
  return {wrapped(i, size, wrap), wrapped(i + 1, size, wrap), at - low};
}

}  // namespace

Texel lookup(const Scene& scene, const Texture& texture, const Vec2& uv) {
  const Picture& p = scene.pictures[static_cast<std::size_t>(texture.picture)];
  const Between x = between(uv.x, p.width, texture.wrap_u), y = between(uv.y, p.height, texture.wrap_v);
  const Texel a = texel(p, x.first, y.first), b = texel(p, x.second, y.first);
  const Texel c = texel(p, x.first, y.second), d = texel(p, x.second, y.second);
  Texel mixed;
  for (std::size_t i = 0; i < 4; ++i) {
    const float top = a[i] + (b[i] - a[i]) * x.share, bottom = c[i] + (d[i] - c[i]) * x.share;
    mixed[i] = top + (bottom - top) * y.share;
  }
  return mixed;
}

Color average(const Picture& p) {
  double sum[3] = {};
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const Texel t = texel(p, x, y);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += t[c];
    }
  const double n = std::max(1.0, double(p.width) * p.height);
  return {float(sum[0] / n), float(sum[1] / n), float(sum[2] / n)};
}

}  // namespace tessera::tracer
