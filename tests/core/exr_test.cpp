// SPDX-License-Identifier: Apache-2.0
#include "core/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <random>

#include "core/pending_file.h"
#include "tests/core/exr_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class Exr : public ExrFixture {};

ExrImage image_of(const Region& data, const Region& display, std::vector<ExrChannel> channels) {
  ExrImage image{display, Image(data, static_cast<int>(channels.size())), std::move(channels), {}};
  std::mt19937 random(7);
  std::uniform_real_distribution<float> value(-2.0f, 10.0f);
  for (float& v : image.pixels.data()) v = value(random);
  return image;
}

TEST_F(Exr, GivesBackWindowsChannelsMetadataAndEveryFloat) {
  ExrImage image =
      image_of({-3, 5, 34, 58}, {0, 0, 640, 480},
               {{"Z", ExrType::float32}, {"A", ExrType::float32}, {"albedo.G", ExrType::float32}});
  image.metadata = {
      {"tessera/version", "1.2"}, {"tessera/error of a rather long name", 0.25f}, {"tessera/seed", 42}};
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    write_exr(file(), image, compression);
    const ExrImage back = read_exr(file());
    EXPECT_EQ(back.display, image.display);
    EXPECT_EQ(back.channels,
              (std::vector<ExrChannel>{
                  {"A", ExrType::float32}, {"Z", ExrType::float32}, {"albedo.G", ExrType::float32}}));
    ASSERT_EQ(back.pixels.region(), image.pixels.region());
    for (const ExrChannel& c : image.channels)
      EXPECT_TRUE(
          std::ranges::equal(back.pixels.plane(back.plane(c.name)), image.pixels.plane(image.plane(c.name))))
          << compression << " " << c.name;
    for (const auto& [name, value] : image.metadata) EXPECT_EQ(back.metadata.at(name), value) << name;
  }
  EXPECT_EQ(files(), 1u) << "only the file itself is left";
}

TEST_F(Exr, KeepsAttributesThatItDoesNotLookAt) {
  {
    Imf::Header header(4, 3);
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    header.compression() = Imf::PIZ_COMPRESSION;
    header.insert("worldToCamera", Imf::M44fAttribute(Imath::M44f(2.0f)));
    header.screenWindowCenter() = {0.25f, -0.5f};
    header.pixelAspectRatio() = 2;
    header.insert("chromaticities", Imf::ChromaticitiesAttribute(Imf::Chromaticities()));
    std::vector<float> pixels(12, 1.0f);
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice::Make(Imf::FLOAT, pixels.data(), header.dataWindow()));
    Imf::OutputFile out(file().c_str(), header);
    out.setFrameBuffer(buffer);
    out.writePixels(3);
  }
  ExrImage image = read_exr(file());
  image.channels[0].name = "Z";
  write_exr(file(), image, "zip");
  Imf::InputFile back(file().c_str());
  const auto* matrix = back.header().findTypedAttribute<Imf::M44fAttribute>("worldToCamera");
  ASSERT_NE(matrix, nullptr);
  EXPECT_EQ(matrix->value(), Imath::M44f(2.0f));
  EXPECT_NE(back.header().find("chromaticities"), back.header().end());
  EXPECT_EQ(back.header().screenWindowCenter(), Imath::V2f(0.25f, -0.5f)) << "which every header has";
  EXPECT_EQ(back.header().pixelAspectRatio(), 2);
  EXPECT_EQ(back.header().compression(), Imf::ZIP_COMPRESSION) << "how a file is stored is its own affair";
}

TEST_F(Exr, ReadsBackWhatEveryCompressionWrote) {
  const ExrImage image = image_of({0, 0, 61, 43}, {0, 0, 61, 43}, {{"R"}, {"Z", ExrType::float32}});
  for (const std::string& compression : exr_compressions()) {
    write_exr(file(), image, compression);
    EXPECT_EQ(read_exr(file()).channels, image.channels) << compression;
  }
  EXPECT_THAT(error_of([&] { write_exr(file(), image, "jpeg"); }),
              HasSubstr("accepted: none rle zips zip piz"));
}

TEST_F(Exr, HalvesAreRoundedToNearestAndOnlyInfinitiesBecomeInfinite) {
  ExrImage image{{}, Image({0, 0, 8, 1}, 1), {{"R"}}, {}};
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> in{1e30f, -3e38f,        65519.9f, 1.0f + 1.0f / 1024 * 0.75f,
                              1e-3f, std::nanf(""), inf,      -inf};
  std::ranges::copy(in, image.pixels.plane(0).begin());
  write_exr(file(), image);
  ExrImage back = read_exr(file());
  write_exr(file(), back);
  back = read_exr(file());
  const auto out = back.pixels.plane(0);
  EXPECT_EQ(out[0], 65504.0f);
  EXPECT_EQ(out[1], -65504.0f);
  EXPECT_EQ(out[2], 65504.0f);
  EXPECT_EQ(out[3], 1.0f + 1.0f / 1024);
  EXPECT_NEAR(out[4], 1e-3f, 1e-3f / 2048);
  EXPECT_TRUE(std::isnan(out[5]));
  EXPECT_EQ(out[6], inf) << "a sky's depth stays one";
  EXPECT_EQ(out[7], -inf);
  EXPECT_EQ(back.display, image.pixels.region()) << "without a display window it is the data window";
}

TEST_F(Exr, AFailedWriteLeavesTheOldFileAndNothingElse) {
  ExrImage image = image_of({0, 0, 8, 8}, {0, 0, 8, 8}, {{"R"}});
  write_exr(file(), image);
  image.channels = {{""}};
  EXPECT_THROW(write_exr(file(), image), InputError);
  image.channels = {{"R"}};
  image.metadata["compression"] = "of another type";  // one of OpenEXR's own attributes
  EXPECT_THROW(write_exr(file(), image), InputError);
  EXPECT_EQ(read_exr(file()).channels.front().name, "R");
  EXPECT_EQ(files(), 1u);
  EXPECT_THAT(error_of([&] { write_exr(file("no/such/folder.exr"), image); }),
              HasSubstr("cannot be written"));
  fs::create_directory(file("folder.exr"));
  image.metadata.clear();
  EXPECT_THROW(write_exr(file("folder.exr"), image), InputError);
  EXPECT_EQ(files(), 2u);
}

TEST_F(Exr, RefusesTwoChannelsOfOneName) {
  const ExrImage image = image_of({0, 0, 8, 8}, {0, 0, 8, 8}, {{"R"}, {"R"}});
  EXPECT_THAT(error_of([&] { write_exr(file(), image); }), HasSubstr("channel 'R'"));
}

TEST_F(Exr, SaysWhatIsWrongWithFilesThatAreNoImages) {
  EXPECT_THAT(error_of([&] { read_exr(file()); }), HasSubstr(file().string()));
  std::ofstream(file()) << "this is text";
  EXPECT_THAT(error_of([&] { read_exr(file()); }), HasSubstr("cannot be read"));
  std::ofstream(file("empty.exr"));
  EXPECT_THROW(read_exr(file("empty.exr")), InputError);
  EXPECT_THROW(read_exr(file().parent_path()), InputError) << "a folder";
}

TEST_F(Exr, RefusesAnAttributeThatReachesBeyondTheFileBeforeMemoryIsTaken) {
  std::string bytes("v/1\1\2\0\0\0comments\0string\0\xff\xff\xff\x7f", 28);
  std::ofstream(file(), std::ios::binary) << bytes << std::string(100, 'x');
  EXPECT_THAT(error_of([&] { read_exr(file()); }), HasSubstr("its header promises more than it holds"));
}

TEST_F(Exr, RefusesAFileCutShort) {
  write_exr(file(), image_of({0, 0, 64, 64}, {0, 0, 64, 64}, {{"R"}}));
  fs::resize_file(file(), fs::file_size(file()) - 100);
  EXPECT_THAT(error_of([&] { read_exr(file()); }), HasSubstr("cannot be read"));
}

// A header without pixels.
void write_header(const fs::path& file, const Imf::Header& header) {
  Imf::OutputFile out(file.c_str(), header);
}

TEST_F(Exr, RefusesAbsurdSizesBeforeItAllocatesThem) {
  Imf::Header wide(65537, 1);
  wide.channels().insert("R", Imf::Channel());
  write_header(file(), wide);
  EXPECT_THAT(error_of([&] { read_exr(file()); }), HasSubstr("65537 x 1"));
  Imf::Header large(65536, 32769);
  large.compression() = Imf::DWAB_COMPRESSION;
  large.channels().insert("R", Imf::Channel());
  write_header(file(), large);
  EXPECT_THAT(error_of([&] { read_exr(file()); }), HasSubstr("values"));
  Imf::Header many(4, 4);
  for (int i = 0; i < 1025; ++i) many.channels().insert(fmt::format("c{}", i), Imf::Channel());
  write_header(file(), many);
  EXPECT_THAT(error_of([&] { read_exr(file()); }), HasSubstr("1025 channels"));
}

TEST_F(Exr, RefusesMorePixelsThanItsBytesCanHold) {
  Imf::Header large(32768, 32768);
  large.compression() = Imf::DWAB_COMPRESSION;
  large.channels().insert("R", Imf::Channel());
  write_header(file(), large);
  EXPECT_LT(fs::file_size(file()), 16384u);
  EXPECT_THAT(error_of([&] { read_exr(file()); }), HasSubstr("complete file"));
}

TEST_F(Exr, RefusesSubsampledChannels) {
  Imf::Header header(4, 4);
  header.channels().insert("RY", Imf::Channel(Imf::HALF, 2, 2));
  write_header(file(), header);
  EXPECT_THAT(error_of([&] { read_exr(file()); }), HasSubstr("subsampled"));
}

TEST_F(Exr, ReadsTiledFilesAndIntegerChannels) {
  Imf::Header header(5, 3);
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  header.setTileDescription({2, 2, Imf::ONE_LEVEL});
  std::vector<unsigned> ids(15);
  std::iota(ids.begin(), ids.end(), 100u);
  {
    Imf::TiledOutputFile out(file().c_str(), header);
    Imf::FrameBuffer buffer;
    buffer.insert("id", Imf::Slice::Make(Imf::UINT, ids.data(), header.dataWindow()));
    out.setFrameBuffer(buffer);
    out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
  }
  const ExrImage image = read_exr(file());
  EXPECT_EQ(image.pixels.at(0, 4, 2), 114.0f);
  EXPECT_EQ(image.channels[0].type, ExrType::uint32);
}

// Whatever bytes are turned, the answer is an image or an InputError.
TEST_F(Exr, DamagedFilesCostAnInputErrorAndNothingMore) {
  const ExrImage image = image_of({-2, 1, 23, 20}, {0, 0, 40, 30}, {{"R"}, {"G"}, {"Z", ExrType::float32}});
  int refused = 0;
  for (const std::string& compression : exr_compressions()) {
    write_exr(file(), image, compression);
    const std::string good = bytes_of(file());
    for (unsigned seed = 0; seed < 60; ++seed) {
      std::mt19937 random(seed);
      std::string bad = good;
      const std::size_t reach =
          seed % 2 ? bad.size() : std::min<std::size_t>(400, bad.size());  // often the header
      for (unsigned i = 0; i <= random() % 4; ++i) bad[random() % reach] = static_cast<char>(random());
      if (random() % 5 == 0) bad.resize(random() % bad.size());
      std::ofstream(file("bad.exr"), std::ios::binary) << bad;
      try {
        read_exr(file("bad.exr"));
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100);
}

TEST_F(Exr, PendingFilesOfOneNameDoNotMeet) {
  PendingFile first(file()), second(file());
  EXPECT_NE(first.temporary(), second.temporary());
  EXPECT_EQ(first.temporary().parent_path(), file().parent_path());
  EXPECT_THAT(first.temporary().filename().string(), testing::StartsWith("a.exr.tmp-"));
}

}  // namespace
}  // namespace tessera
