// SPDX-License-Identifier: Apache-2.0
// Channels of unsigned integers: floats do not hold them all.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "core/exr.h"
#include "tests/core/exr_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using Integers = std::vector<std::uint32_t>;

class ExrIntegers : public ExrFixture {
 protected:
  // One line.
  void write(const Integers& ids) const {
    Imf::Header header(static_cast<int>(ids.size()), 1);
    header.channels().insert("id", Imf::Channel(Imf::UINT));
    Imf::FrameBuffer buffer;
    buffer.insert("id", Imf::Slice::Make(Imf::UINT, ids.data(), header.dataWindow()));
    Imf::OutputFile out(file().c_str(), header);
    out.setFrameBuffer(buffer);
    out.writePixels(1);
  }
  // As OpenEXR reads them, of a channel that must hold integers.
  Integers read(const std::string& channel = "id") const {
    Imf::InputFile in(file().c_str());
    const Imf::Channel* found = in.header().channels().findChannel(channel);
    if (found == nullptr || found->type != Imf::UINT) return {};
    Integers ids(static_cast<std::size_t>(in.header().dataWindow().max.x) + 1);
    Imf::FrameBuffer buffer;
    buffer.insert(channel, Imf::Slice::Make(Imf::UINT, ids.data(), in.header().dataWindow()));
    in.setFrameBuffer(buffer);
    in.readPixels(0);
    return ids;
  }
};

const Integers kIds{0, 1, 0xffff, 0x1000000, 0x1000001, 0x7fffffff, 0x80000001, 0xfffffffe, 0xffffffff};

TEST_F(ExrIntegers, ComeBackToTheBitByEveryCompression) {
  for (const std::string& compression : exr_compressions()) {
    write(kIds);
    const ExrImage image = read_exr(file());
    EXPECT_EQ(image.channels, (std::vector<ExrChannel>{{"id", ExrType::uint32}}));
    EXPECT_EQ(image.pixels.at(0, 2, 0), 65535.0f);
    EXPECT_EQ(image.pixels.at(0, 8, 0), 4294967296.0f) << "as near as a float is";
    write_exr(file(), image, compression);
    EXPECT_EQ(read(), kIds) << compression;
  }
}

TEST_F(ExrIntegers, AreKeptBesideThePlanesOnlyWhereFloatsDoNotHoldThem) {
  write({0, 1, 0xffff, 0x1000000, 0x80000000});
  const ExrImage image = read_exr(file());
  EXPECT_TRUE(image.integers.empty());
  write_exr(file(), image);
  EXPECT_EQ(read(), (Integers{0, 1, 0xffff, 0x1000000, 0x80000000}));
}

TEST_F(ExrIntegers, OfAPlaneThatWasChangedAreTheNewValuesRounded) {
  write(kIds);
  ExrImage image = read_exr(file());
  const float changed[] = {-1, 2.5f, std::nanf(""), 1e30f, 7.6f, INFINITY, -INFINITY};
  std::ranges::copy(changed, image.pixels.plane(0).begin());
  write_exr(file(), image);
  EXPECT_EQ(read(), (Integers{0, 2, 0, 0xffffffff, 8, 0xffffffff, 0, 0xfffffffe, 0xffffffff}));
}

TEST_F(ExrIntegers, OfAnotherNameOrSizeAreThePlanesValues) {
  write(kIds);
  const ExrImage image = read_exr(file());
  const Integers rounded{0, 1, 0xffff, 0x1000000, 0x1000000, 0x80000000, 0x80000000, 0xffffffff, 0xffffffff};
  ExrImage renamed = image;
  renamed.channels[0].name = "other";
  write_exr(file(), renamed);
  EXPECT_EQ(read("other"), rounded);
  ExrImage crop = image;
  crop.pixels = cropped(image.pixels, {0, 0, 7, 1});
  write_exr(file(), crop);
  EXPECT_EQ(read(), Integers(rounded.begin(), rounded.begin() + 7));
}

TEST_F(ExrIntegers, CountAsTwoValues) {
  write(kIds);
  EXPECT_NO_THROW(read_exr(file(), 18));
  EXPECT_THAT(error_of([&] { read_exr(file(), 17); }), HasSubstr("at most 17"));
}

}  // namespace
}  // namespace tessera
