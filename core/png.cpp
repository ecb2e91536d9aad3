// SPDX-License-Identifier: Apache-2.0
#include "core/png.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/pending_file.h"
#include "core/quality/display.h"

namespace tessera {
namespace {

constexpr int kCompression = 3;  // of 9; the usual 6 takes twice as long, for files that are a sixth smaller

using Rgb = std::array<float, 3>;

// Linear sRGB of an OKLab colour given as lightness, chroma and hue (Ottosson 2020).
Rgb from_oklch(float lightness, float chroma, float hue) {
  const float a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const auto cube = [](float v) { return v * v * v; };
  const float l = cube(lightness + 0.3963377774f * a + 0.2158037573f * b);
  const float m = cube(lightness - 0.1055613458f * a - 0.0638541728f * b);
  const float s = cube(lightness - 0.0894841775f * a - 1.2914855480f * b);
  return {4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s,
          -1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s,
          -0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s};
}

// A straight ramp of lightness in OKLab, while the hue turns from blue-purple by red to yellow and the chroma
// swells and fades, so that equal steps of t look like equal steps and no colour leaves the gamut by much.
Rgb heat(float t) {
  constexpr float kDegree = std::numbers::pi_v<float> / 180.0f;
  const float lightness = 0.08f + 0.87f * t;
  const float chroma = 0.17f * std::pow(std::sin(std::numbers::pi_v<float> * (0.06f + 0.80f * t)), 0.8f);
  Rgb c = from_oklch(lightness, chroma, (290.0f + 175.0f * t) * kDegree);
  for (float& v : c) v = std::clamp(v, 0.0f, 1.0f);
  return c;
}

unsigned char byte(float v) { return std::isnan(v) ? 0 : static_cast<unsigned char>(v * 255.0f + 0.5f); }

// PNG's colours are not multiplied by their alpha.
Image without_alpha(const Image& image) {
  Image colors(image.region(), 3);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < colors.plane(c).size(); ++i) {
      const float alpha = image.planes() > 3 ? image.plane(3)[i] : 1.0f;
      colors.plane(c)[i] = alpha > 0 ? image.plane(c)[i] / alpha : 0.0f;
    }
  return colors;
}

std::vector<unsigned char> bytes_of(const Image& image, int channels, float exposure) {
  const Image shown = displayed(without_alpha(image), {.exposure = exposure});
  const std::size_t area = shown.plane(0).size(), n = static_cast<std::size_t>(channels);
  std::vector<unsigned char> bytes(area * n);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < area; ++i)
      bytes[n * i + static_cast<std::size_t>(c)] = byte(shown.plane(c)[i]);
  for (std::size_t i = 0; channels == 4 && i < area; ++i)
    bytes[n * i + 3] = byte(std::clamp(image.plane(3)[i], 0.0f, 1.0f));
  return bytes;
}

}  // namespace

void write_png(const std::filesystem::path& file, const Image& image, float exposure) {
  assert(image.planes() >= 3 && !image.empty());
  const auto fail = [&](const std::string& why) {
    throw InputError(file.string(), "cannot be written: " + why, "a writable folder");
  };
  const int channels = image.planes() > 3 ? 4 : 3;
  const std::vector<unsigned char> bytes = bytes_of(image, channels, exposure);
  OIIO::ImageSpec spec(image.region().width(), image.region().height(), channels, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("png:compressionLevel", kCompression);
  PendingFile pending(file);
  const auto out = OIIO::ImageOutput::create("png");
  if (!out) fail(OIIO::geterror());
  if (!out->open(pending.temporary().string(), spec) ||
      !out->write_image(OIIO::TypeDesc::UINT8, bytes.data()) || !out->close())
    fail(out->geterror());
  try {
    pending.commit();
  } catch (const std::filesystem::filesystem_error& e) {
    fail(e.code().message());
  }
}

Image heat_map(const Image& values, float low, float high) {
  assert(values.planes() >= 1);
  std::array<Rgb, 1024> ramp;
  const float last = static_cast<float>(ramp.size() - 1);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = heat(static_cast<float>(i) / last);
  const float scale = high > low ? 1.0f / (high - low) : 0.0f;
  Image out(values.region(), 3);
  const auto from = values.plane(0);
  for (std::size_t i = 0; i < from.size(); ++i) {
    const float t = std::clamp((from[i] - low) * scale, 0.0f, 1.0f);
    const Rgb c = std::isnan(t) ? Rgb{0, 1, 1} : ramp[static_cast<std::size_t>(t * last + 0.5f)];
    for (int p = 0; p < 3; ++p) out.plane(p)[i] = c[p];
  }
  return out;
}

Image side_by_side(const std::vector<Image>& images, int gap) {
  assert(!images.empty() && gap >= 0);
  int width = -gap;
  for (const Image& image : images) width += image.region().width() + gap;
  const int height = images.front().region().height();
  Image sheet({0, 0, width, height}, 3, 1.0f);
  int left = 0;
  for (const Image& image : images) {
    const Region r = image.region();
    assert(r.height() == height && image.planes() >= 3);
    for (int p = 0; p < 3; ++p)
      for (int y = 0; y < height; ++y)
        std::ranges::copy(image.row(p, r.y0 + y), sheet.row(p, y).begin() + left);
    left += r.width() + gap;
  }
  return sheet;
}

}  // namespace tessera
