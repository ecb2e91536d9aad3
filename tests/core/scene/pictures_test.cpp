// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/scene/folder.h"

namespace tessera {
namespace {

using testing::HasSubstr;

std::string refusal_of(const std::filesystem::path& file) {
  try {
    read_picture(file, Encoding::srgb);
  } catch (const InputError& e) {
    return e.what();
  }
  return "read";
}

TEST(Pictures, AreDecodedToLinearWithRowZeroOnTop) {
  const Picture p = read_picture(kData / "corners.png", Encoding::srgb);
  ASSERT_EQ(p.pixels.size(), 16u);
  EXPECT_EQ(std::vector<float>(p.pixels.begin(), p.pixels.begin() + 4), (std::vector<float>{1, 0, 0, 1}));
  EXPECT_EQ(std::vector<float>(p.pixels.begin() + 8, p.pixels.begin() + 12),
            (std::vector<float>{0, 0, 1, 1}));
  EXPECT_NEAR(p.pixels[12], 0.502886, 1e-5) << "sRGB 188 is about one half, and not multiplied by alpha";
  EXPECT_FLOAT_EQ(p.pixels[15], 128.0f / 255) << "alpha is linear";
}

TEST(Pictures, ARadianceFileIsLinearWhateverIsAsked) {
  const Folder folder;
  // One pixel, not run-length encoded: (128, 64, 32) / 256 * 2^(129 - 128).
  const auto file = folder.write(
      "one.hdr", std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n") + "\x80\x40\x20\x81");
  const Picture p = read_picture(file, Encoding::srgb);
  ASSERT_EQ(p.pixels.size(), 3u);
  EXPECT_NEAR(p.pixels[0], 1.0f, 0.005f);
  EXPECT_NEAR(p.pixels[1], 0.5f, 0.005f);
  EXPECT_NEAR(p.pixels[2], 0.25f, 0.005f);
}

TEST(Pictures, WhatIsNoImageIsRefusedWithItsNameAndTheFormats) {
  const Folder folder;
  const std::string png = contents(kData / "corners.png");
  EXPECT_THAT(refusal_of(folder.write("text.png", "hello")), HasSubstr("text.png: "));
  EXPECT_THAT(refusal_of(folder.write("text.txt", "hello")), HasSubstr("accepted: PNG, JPEG"));
  EXPECT_THAT(refusal_of(folder.write("empty.png", "")), HasSubstr("empty.png: "));
  EXPECT_THAT(refusal_of(folder.write("short.png", png.substr(0, 50))), HasSubstr("short.png: "));
  EXPECT_THAT(refusal_of(folder.path() / "none.png"), HasSubstr("none.png: no such file"));
  EXPECT_THAT(refusal_of(folder.path()), HasSubstr("is not a file"));
}

TEST(Pictures, AnAbsurdSizeIsRefusedBeforeMemoryIsTaken) {
  const Folder folder;
  EXPECT_THAT(refusal_of(folder.write("huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 16385\n")),
              HasSubstr("16385 x 1"));
  EXPECT_THAT(
      refusal_of(folder.write("huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n")),
      HasSubstr("16384 x 16384"));
}

TEST(PictureShelf, HoldsAFileOnceForEachEncoding) {
  Scene scene;
  PictureShelf shelf(scene);
  const int srgb = shelf.place(kData / "corners.png", Encoding::srgb);
  EXPECT_EQ(shelf.place(kData / "." / "corners.png", Encoding::srgb), srgb);
  EXPECT_NE(shelf.place(kData / "corners.png", Encoding::linear), srgb);
  EXPECT_EQ(scene.pictures.size(), 2u);
}

}  // namespace
}  // namespace tessera
