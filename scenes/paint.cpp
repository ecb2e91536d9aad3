// SPDX-License-Identifier: Apache-2.0
#include "scenes/paint.h"

#include <Imath/ImathVec.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace tessera::scenes {
namespace {

using Vec3 = Imath::V3f;
constexpr float kPi = std::numbers::pi_v<float>;

// Writes color(u, v), u and v from 0 to 1 from the top left.
void paint(const std::filesystem::path& file, int width, int height, OIIO::TypeDesc stored,
           const std::function<Vec3(float, float)>& color) {
  std::vector<float> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec3 c = color((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                           (static_cast<float>(y) + 0.5f) / static_cast<float>(height));
      pixels.insert(pixels.end(), {c.x, c.y, c.z});
    }
  const auto out = OIIO::ImageOutput::create(file.string());
  if (!out || !out->open(file.string(), OIIO::ImageSpec(width, height, 3, stored)) ||
      !out->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) || !out->close())
    throw std::runtime_error(file.string() + ": cannot be written");
}

float smooth(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

// How far a point of the tile is inside an eight-pointed star of the given size, in tiles; below 0 outside.
float inside_star(float x, float y, float size) {
  const float straight = std::max(std::abs(x), std::abs(y)),
              slanted = (std::abs(x) + std::abs(y)) * std::sqrt(0.5f);
  return size - std::min(straight, slanted);
}

// Distance to the nearest groove between pieces of the mosaic, in tiles.
float to_groove(float u, float v) {
  const float x = u - 0.5f, y = v - 0.5f;
  const float edge = 0.5f - std::max(std::abs(x), std::abs(y));
  const float corner = (1 - std::abs(x) - std::abs(y)) * std::sqrt(0.5f) - 0.16f;
  return std::min({std::abs(inside_star(x, y, 0.34f)), std::abs(inside_star(x, y, 0.17f)), edge + 0.004f,
                   std::abs(corner)});
}

float height(float u, float v) {
  return smooth(0.003f, 0.016f, to_groove(u - std::floor(u), v - std::floor(v)));
}

Vec3 tile_color(float u, float v) {
  const float x = u - 0.5f, y = v - 0.5f;
  const float corner = (1 - std::abs(x) - std::abs(y)) * std::sqrt(0.5f) - 0.16f;
  const Vec3 grout(0.62f, 0.57f, 0.50f), cream(0.88f, 0.82f, 0.70f), blue(0.12f, 0.27f, 0.46f),
      teal(0.13f, 0.45f, 0.44f), ochre(0.78f, 0.52f, 0.20f);
  Vec3 glaze = cream;
  if (inside_star(x, y, 0.34f) > 0) glaze = blue;
  if (inside_star(x, y, 0.17f) > 0) glaze = ochre;
  if (corner < 0) glaze = teal;
  const float firing =
      1 + 0.06f * std::sin(23 * u + 9 * v) * std::sin(17 * v - 5 * u);  // hand-made, not even
  return grout + (glaze * firing - grout) * height(u, v);
}

// A normal map of `field`, whose bumps are `strength` high for one repeat of the picture.
Vec3 normal_of(const std::function<float(float, float)>& field, float u, float v, float strength) {
  constexpr float step = 1.0f / 1024;
  const float across = (field(u + step, v) - field(u - step, v)) / (2 * step),
              down = (field(u, v + step) - field(u, v - step)) / (2 * step);
  return Vec3(-strength * across, strength * down, 1).normalized() * 0.5f + Vec3(0.5f);
}

float ripples(float u, float v) {
  float sum = 0;
  constexpr int kWaves[][2] = {{3, 1}, {-2, 4}, {5, -3}, {1, 6}, {-7, 2}, {4, 7}, {9, -4}};
  for (const auto& [a, b] : kWaves) {
    const float length = std::hypot(static_cast<float>(a), static_cast<float>(b));
    sum += std::sin(2 * kPi * (static_cast<float>(a) * u + static_cast<float>(b) * v) + length * length) /
           length;
  }
  return sum;
}

}  // namespace

void paint_tiles(const std::filesystem::path& folder) {
  paint(folder / "tiles.png", 512, 512, OIIO::TypeDesc::UINT8, tile_color);
  paint(folder / "tiles_normal.png", 512, 512, OIIO::TypeDesc::UINT8,
        [](float u, float v) { return normal_of(height, u, v, 0.006f); });
  paint(folder / "tiles_rough.png", 512, 512, OIIO::TypeDesc::UINT8, [](float u, float v) {
    const float polish = 0.48f + 0.06f * std::sin(31 * u) * std::sin(29 * v);
    return Vec3(0, 0.9f + (polish - 0.9f) * height(u, v), 0);
  });
}

void paint_ripples(const std::filesystem::path& folder) {
  paint(folder / "ripples.png", 256, 256, OIIO::TypeDesc::UINT8,
        [](float u, float v) { return normal_of(ripples, u, v, 0.004f); });
}

void paint_sky(const std::filesystem::path& folder, float sun_bearing) {
  paint(folder / "sky.hdr", 256, 128, OIIO::TypeDesc::FLOAT, [&](float u, float v) {
    const float up = std::sin(kPi * (0.5f - v)), bearing = 2 * kPi * (u - 0.5f);
    const float towards_sun = 0.5f + 0.5f * std::cos(bearing - sun_bearing);
    const Vec3 zenith(0.13f, 0.25f, 0.58f), above(0.40f, 0.50f, 0.72f), warm(1.7f, 0.85f, 0.45f),
        ground(0.20f, 0.16f, 0.12f);
    const float glow = std::exp(-std::max(up, 0.0f) * 4.5f) * (0.4f + 0.6f * towards_sun * towards_sun);
    const Vec3 sky = above + (zenith - above) * smooth(0.0f, 0.75f, up) + (warm - above) * glow;
    return sky + (ground - sky) * smooth(0.0f, -0.05f, up);
  });
}

}  // namespace tessera::scenes
