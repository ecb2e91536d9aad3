// SPDX-License-Identifier: Apache-2.0
#include "core/png.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "core/error.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

TEST(Png, HoldsTheLinearImageAsSrgbBytes) {
  const fs::path folder =
      fs::path(testing::TempDir()) / ("tessera-png" + std::to_string(std::random_device{}()));
  fs::create_directories(folder);
  Image image({10, 20, 15, 21}, 3);
  const std::array<float, 5> red{0.0f, 0.002f, 0.21586f, 7.0f, std::nanf("")};
  std::ranges::copy(red, image.plane(0).begin());
  write_png(folder / "a.png", image);
  write_png(folder / "bright.png", image, 1.0f);
  const auto bytes = [&](const char* name) {
    const auto in = OIIO::ImageInput::open((folder / name).string());
    EXPECT_TRUE(in && in->spec().width == 5 && in->spec().height == 1 && in->spec().nchannels == 3);
    std::vector<unsigned char> all(15);
    in->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, all.data());
    return std::vector<int>{all[0], all[3], all[6], all[9], all[12], all[13]};
  };
  // 12.92 * 0.002 * 255 = 6.59; sRGB of 0.21586 is 127.5 / 255 rounded up, of twice that 0.6888 (175.6).
  EXPECT_EQ(bytes("a.png"), (std::vector<int>{0, 7, 128, 255, 0, 0}));
  EXPECT_EQ(bytes("bright.png"), (std::vector<int>{0, 13, 176, 255, 0, 0}));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2) << "no temporary files";
  EXPECT_THROW(write_png(folder / "no" / "such.png", image), InputError);
  fs::remove_all(folder);
}

// Linear sRGB to OKLab (Ottosson 2020), in the direction the map does not use.
std::array<double, 3> oklab(const Image& image, int x) {
  const double r = image.at(0, x, 0), g = image.at(1, x, 0), b = image.at(2, x, 0);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

TEST(HeatMap, ClimbsFromDarkToLightInEvenSteps) {
  constexpr int kSteps = 64;
  Image values({0, 0, kSteps + 1, 1}, 1);
  for (int i = 0; i <= kSteps; ++i) values.at(0, i, 0) = static_cast<float>(i);
  const Image map = heat_map(values, 0.0f, kSteps);
  double shortest = 1e9, longest = 0;
  for (int i = 0; i < kSteps; ++i) {
    const auto a = oklab(map, i), b = oklab(map, i + 1);
    EXPECT_LT(a[0], b[0]) << "lightness at step " << i;
    const double step = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    shortest = std::min(shortest, step), longest = std::max(longest, step);
  }
  EXPECT_LT(longest, 2.5 * shortest);
  EXPECT_LT(oklab(map, 0)[0], 0.15);
  EXPECT_GT(oklab(map, kSteps)[0], 0.9);
}

TEST(HeatMap, ClampsBeyondItsEndsAndMarksNan) {
  Image values({0, 0, 5, 1}, 1);
  const std::array<float, 5> v{-5.0f, 1.0f, 3.0f, 1e30f, std::nanf("")};
  std::ranges::copy(v, values.plane(0).begin());
  const Image map = heat_map(values, 1.0f, 3.0f);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(map.at(c, 0, 0), map.at(c, 1, 0));
    EXPECT_EQ(map.at(c, 2, 0), map.at(c, 3, 0));
    EXPECT_EQ(map.at(c, 4, 0), c == 0 ? 0.0f : 1.0f);
  }
  const Image flat = heat_map(values, 1.0f, 1.0f);
  EXPECT_EQ(flat.at(0, 3, 0), map.at(0, 0, 0)) << "an empty scale shows its low end";
}

TEST(SideBySide, PutsImagesInOrderWithWhiteBetween) {
  const std::vector<Image> images{Image({5, 5, 7, 8}, 3, 0.25f), Image({0, 0, 1, 3}, 4, 0.5f)};
  const Image sheet = side_by_side(images, 2);
  ASSERT_EQ(sheet.region(), (Region{0, 0, 5, 3}));
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 3; ++y) {
      const auto row = sheet.row(c, y);
      EXPECT_EQ((std::vector<float>(row.begin(), row.end())),
                (std::vector<float>{0.25f, 0.25f, 1.0f, 1.0f, 0.5f}));
    }
}

}  // namespace
}  // namespace tessera
