// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pictures.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

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

// Two by two pixels of 24 bits; each test spoils one number.
std::string bitmap() {
  std::string b = "BM";
  const auto add = [&](std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) b += static_cast<char>(value >> (8 * i) & 0xff);
  };
  add(70, 4), add(0, 4), add(54, 4);                                   // file, reserved, pixels
  add(40, 4), add(2, 4), add(2, 4), add(1, 2), add(24, 2), add(0, 4);  // header ... compression
  add(16, 4), add(0, 4), add(0, 4), add(0, 4), add(0, 4);              // bytes ... colours
  return b + std::string("\x00\x00\xff\x00\xff\x00\x00\x00", 8) + std::string(8, '\x7f');
}

TEST(Pictures, ABitmapMustHoldWhatItsHeaderPromises) {
  const Folder folder;
  const auto with = [&](std::size_t at, char value) {
    std::string bytes = bitmap();
    bytes[at] = value;
    return refusal_of(folder.write("made.bmp", bytes));
  };
  EXPECT_EQ(with(0, 'B'), "read");
  EXPECT_EQ(with(25, '\0'), "read");
  EXPECT_THAT(with(13, '\xff'), HasSubstr("promises more")) << "pixels before the file";
  EXPECT_THAT(with(10, '\x00'), HasSubstr("promises more")) << "pixels within the header";
  EXPECT_THAT(with(10, '\x40'), HasSubstr("promises more")) << "pixels that begin late";
  EXPECT_THAT(with(20, '\x70'), HasSubstr("promises more")) << "wide";
  EXPECT_THAT(with(24, '\x70'), HasSubstr("promises more")) << "high";
  EXPECT_THAT(with(25, '\x80'), HasSubstr("promises more")) << "of a negative height";
  EXPECT_THAT(with(28, '\x07'), HasSubstr("promises more")) << "bits that no format has";
  EXPECT_THAT(with(30, '\x01'), HasSubstr("compressed")) << "run lengths";
  EXPECT_THAT(with(49, '\x10'), HasSubstr("promises more")) << "colours";
  EXPECT_THAT(with(14, '\x09'), HasSubstr("promises more")) << "a header of no known length";
}

TEST(Pictures, AnAbsurdSizeIsRefusedBeforeMemoryIsTaken) {
  const Folder folder;
  EXPECT_THAT(refusal_of(folder.write("huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 16385\n")),
              HasSubstr("16385 x 1"));
  EXPECT_THAT(
      refusal_of(folder.write("huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n")),
      HasSubstr("16384 x 16384"));
}

long peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

TEST(Pictures, RowsThatAreNotThereTakeNoMemory) {
  const Folder folder;
  const auto file = folder.write("promise.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8000 +X 8000\n");
  const long before = peak_mib();
  EXPECT_THAT(refusal_of(file), HasSubstr("promise.hdr: "));
  EXPECT_LT(peak_mib() - before, 300) << "its pixels would be 732 MiB";
}

TEST(Pictures, AnExrAttributeThatReachesBeyondTheFileIsRefused) {
  const Folder folder;
  const std::string start("v/1\1\2\0\0\0note\0any\0", 17);
  for (const std::uint32_t size : {1u, 0x7fffffffu, 0xffffffffu}) {
    std::string bytes = start;
    bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
    EXPECT_THAT(refusal_of(folder.write("note.exr", bytes)), HasSubstr("note.exr: the image promises more"))
        << size;
  }
}

TEST(Pictures, AnExrFileWhoseRowsOrTilesWouldNotFitIsRefusedBeforeMemoryIsTaken) {
  const Folder folder;
  const auto with = [&](std::string_view name, std::vector<std::int32_t> numbers) {
    std::string bytes("v/1\1\2\0\0\0", 8);
    bytes.append(name).append("\0any\0", 5);
    const auto size = static_cast<std::uint32_t>(numbers.size() * sizeof(std::int32_t));
    bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
    bytes.append(reinterpret_cast<const char*>(numbers.data()), size).append(1, '\0');
    return refusal_of(folder.write("made.exr", bytes));
  };
  EXPECT_THAT(with("dataWindow", {0, 0, 0x970000, 1}), HasSubstr("an edge of more than 16384"));
  EXPECT_THAT(with("dataWindow", {INT32_MIN, 0, INT32_MAX, 1}), HasSubstr("an edge of more than 16384"));
  EXPECT_THAT(with("dataWindow", {0, 5, 1, 3}), HasSubstr("an edge of more than 16384"));
  EXPECT_THAT(with("tiles", {1 << 30, 16, 0}), HasSubstr("an edge of more than 16384"));
  EXPECT_THAT(with("dataWindow", {0, 0, 16383, 1}), testing::Not(HasSubstr("an edge of more than")));
}

TEST(Pictures, OfManyRowsAreReadWholeTiledOrNot) {
  const Folder folder;
  std::vector<float> pixels;
  for (int i = 0; i < 70 * 600 * 3; ++i) pixels.push_back(static_cast<float>(i));
  for (const int tile : {0, 32}) {
    OIIO::ImageSpec spec(70, 600, 3, OIIO::TypeDesc::FLOAT);
    spec.tile_width = spec.tile_height = tile;
    const std::string name = (folder.path() / "many.exr").string();
    const auto out = OIIO::ImageOutput::create(name);
    ASSERT_TRUE(out && out->open(name, spec) && out->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) &&
                out->close());
    EXPECT_EQ(read_picture(name, Encoding::linear).pixels, pixels) << tile;
  }
}

TEST(PictureShelf, HoldsAFileOnceForEachEncoding) {
  Scene scene;
  PictureShelf shelf(scene);
  const int srgb = shelf.place(kData / "corners.png", Encoding::srgb);
  EXPECT_EQ(shelf.place(kData / "." / "corners.png", Encoding::srgb), srgb);
  EXPECT_NE(shelf.place(kData / "corners.png", Encoding::linear), srgb);
  EXPECT_EQ(scene.pictures.size(), 2u);
}

TEST(PictureShelf, ATextureIsDecodedToTheEndButItsPixelsAreNotKept) {
  const Folder folder;
  Scene scene;
  PictureShelf shelf(scene);
  const std::string png = contents(kData / "corners.png");
  const Picture& file = scene.pictures[std::size_t(shelf.place(kData / "corners.png", Encoding::srgb))];
  EXPECT_TRUE(file.pixels.empty());
  EXPECT_EQ(file.width, 2);
  EXPECT_EQ(with_pixels(file).pixels, read_picture(kData / "corners.png", Encoding::srgb).pixels);
  const std::span bytes(reinterpret_cast<const unsigned char*>(png.data()), png.size());
  const Picture& embedded = scene.pictures[std::size_t(shelf.place(bytes, "a.glb#images/0", Encoding::srgb))];
  EXPECT_TRUE(embedded.pixels.empty());
  EXPECT_EQ(with_pixels(embedded).pixels, with_pixels(scene.pictures[0]).pixels);
  // Whole but for the end of its pixels.
  const auto cut = folder.write("cut.png", png.substr(0, png.size() - 16));
  EXPECT_THROW(shelf.place(cut, Encoding::srgb), InputError);
  EXPECT_THROW(shelf.place(bytes.subspan(0, png.size() - 16), "b.glb#images/0", Encoding::srgb), InputError);
  EXPECT_EQ(scene.pictures.size(), 2u);
}

TEST(PictureShelf, KeepsPixelsWhereTheyAreAskedFor) {
  Scene scene;
  PictureShelf shelf(scene);
  const int source = shelf.place(kData / "corners.png", Encoding::srgb);
  const int pixels = shelf.place(kData / "corners.png", Encoding::srgb, {}, Keep::pixels);
  EXPECT_NE(source, pixels);
  EXPECT_EQ(scene.pictures[std::size_t(pixels)].pixels.size(), 16u);
}

TEST(PictureShelf, AUdimNameIsAllItsTilesInOrder) {
  const Folder folder;
  const std::string png = contents(kData / "corners.png");
  for (const char* name :
       {"a.1012.png", "a.1001.png", "a.1000.png", "a.10010.png", "b.1002.png", "a.1003.jpg"})
    folder.write(name, png);
  Scene scene;
  const Picture& set =
      scene
          .pictures[std::size_t(PictureShelf(scene).place(folder.path() / "a.<UDIM>.png", Encoding::linear))];
  ASSERT_EQ(set.tiles.size(), 2u);
  EXPECT_EQ(set.tiles[0].udim, 1001);
  EXPECT_EQ(set.tiles[1].udim, 1012);
  EXPECT_EQ(with_pixels(set.tiles[1]).pixels.size(), 16u);
}

TEST(PictureShelf, AUdimNameWithoutTilesOrWithABadOneIsRefused) {
  const Folder folder;
  const auto refusal_of_set = [&] {
    Scene scene;
    try {
      PictureShelf(scene).place(folder.path() / "a.<UDIM>.png", Encoding::linear, "scene.json:/materials");
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("placed");
  };
  EXPECT_THAT(refusal_of_set(), HasSubstr("scene.json:/materials: "));
  EXPECT_THAT(refusal_of_set(), HasSubstr("a.<UDIM>.png: there is no such file"));
  folder.write("a.1001.png", contents(kData / "corners.png"));
  EXPECT_EQ(refusal_of_set(), "placed");
  folder.write("a.1002.png", contents(kData / "corners.png").substr(0, 60));
  EXPECT_THAT(refusal_of_set(), HasSubstr("a.1002.png: "));
}

TEST(Pictures, TiffAndTargaAreReadToo) {
  const Folder folder;
  std::string targa(18 + 3, '\0');
  targa[2] = 2, targa[12] = 1, targa[14] = 1, targa[16] = 24;
  targa[18] = '\xff';  // blue comes first
  EXPECT_EQ(read_picture(folder.write("one.tga", targa), Encoding::srgb).pixels,
            (std::vector<float>{0, 0, 1}));
  // One grey pixel of 255: header, the pixel, and a directory of eight short entries.
  std::string tiff("II*\0\x0a\0\0\0\xff\0", 10);
  const int entries[][3] = {{256, 1, 1}, {257, 1, 1}, {258, 1, 8}, {259, 1, 1},
                            {262, 1, 1}, {273, 1, 8}, {278, 1, 1}, {279, 1, 1}};
  const auto add_number = [&](int value, int bytes) {
    for (int i = 0; i < bytes; ++i) tiff += static_cast<char>(value >> (8 * i));
  };
  add_number(8, 2);
  for (const auto& [tag, count, value] : entries)
    add_number(tag, 2), add_number(3, 2), add_number(count, 4), add_number(value, 4);
  add_number(0, 4);
  EXPECT_EQ(read_picture(folder.write("one.tif", tiff), Encoding::srgb).pixels, (std::vector<float>{1}));
  tiff[8 + 2 + 2 + 5 * 12 + 8] = '\x7f';  // the strip is beyond the file's end
  EXPECT_THAT(refusal_of(folder.write("one.tif", tiff)), HasSubstr("one.tif: "));
}

}  // namespace
}  // namespace tessera
