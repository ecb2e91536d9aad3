// SPDX-License-Identifier: Apache-2.0
// Files of several parts: the parts are layers of one image.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <list>
#include <random>
#include <set>
#include <vector>

#include "core/exr.h"
#include "tests/core/exr_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kWidth = 5, kHeight = 3;

Imf::Header part(const std::string& name, const std::vector<std::string>& channels,
                 Imf::PixelType type = Imf::FLOAT) {
  Imf::Header header(kWidth, kHeight);
  header.setName(name);
  header.setType(Imf::SCANLINEIMAGE);
  for (const std::string& c : channels) header.channels().insert(c, Imf::Channel(type));
  return header;
}

Imf::Header tiled(Imf::Header header) {
  header.setType(Imf::TILEDIMAGE);
  header.setTileDescription({2, 2, Imf::ONE_LEVEL});
  return header;
}

void write_headers(const fs::path& file, const std::vector<Imf::Header>& headers) {
  Imf::MultiPartOutputFile out(file.c_str(), headers.data(), static_cast<int>(headers.size()));
}

// The value of a channel's first pixel; those that follow are more by one each.
float first_value(std::size_t part, int channel) {
  return 100.0f * static_cast<float>(part) + 20.0f * channel;
}

void write_parts(const fs::path& file, const std::vector<Imf::Header>& headers) {
  Imf::MultiPartOutputFile out(file.c_str(), headers.data(), static_cast<int>(headers.size()));
  for (std::size_t p = 0; p < headers.size(); ++p) {
    std::list<std::vector<float>> planes;
    Imf::FrameBuffer buffer;
    int channel = 0;
    for (auto it = headers[p].channels().begin(); it != headers[p].channels().end(); ++it, ++channel) {
      auto& plane = planes.emplace_back(kWidth * kHeight);
      for (std::size_t i = 0; i < plane.size(); ++i)
        plane[i] = first_value(p, channel) + static_cast<float>(i);
      buffer.insert(it.name(), Imf::Slice::Make(Imf::FLOAT, plane.data(), headers[p].dataWindow()));
    }
    if (headers[p].hasTileDescription()) {
      Imf::TiledOutputPart to(out, static_cast<int>(p));
      to.setFrameBuffer(buffer);
      to.writeTiles(0, to.numXTiles() - 1, 0, to.numYTiles() - 1);
    } else {
      Imf::OutputPart to(out, static_cast<int>(p));
      to.setFrameBuffer(buffer);
      to.writePixels(kHeight);
    }
  }
}

class ExrParts : public ExrFixture {
 protected:
  std::string refusal(const std::vector<Imf::Header>& headers) const {
    write_headers(file(), headers);
    return error_of([&] { read_exr(file()); });
  }
};

TEST_F(ExrParts, AreLayersAndAfterwardsOfASinglePart) {
  write_parts(file(), {part("rgba", {"R", "G", "B"}), tiled(part("N", {"X", "Y", "Z"})),
                       part("beauty of rest", {"direct.G", "direct.R", "depth"}), part("7", {"R"})});
  const ExrImage image = read_exr(file());
  const std::vector<std::pair<std::string, float>> expected{
      {"7.R", first_value(3, 0)},      {"B", first_value(0, 0)},
      {"G", first_value(0, 1)},        {"N.X", first_value(1, 0)},
      {"N.Y", first_value(1, 1)},      {"N.Z", first_value(1, 2)},
      {"R", first_value(0, 2)},        {"beauty of rest.depth", first_value(2, 0)},
      {"direct.G", first_value(2, 1)}, {"direct.R", first_value(2, 2)}};
  ASSERT_EQ(image.channels.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(image.channels[i], (ExrChannel{expected[i].first, ExrType::float32}));
    const auto plane = image.pixels.plane(static_cast<int>(i));
    EXPECT_EQ(plane[0], expected[i].second) << expected[i].first;
    EXPECT_EQ(plane[14], expected[i].second + 14) << expected[i].first;
  }
  write_exr(file(), image);
  EXPECT_EQ(Imf::MultiPartInputFile(file().c_str()).parts(), 1);
  const ExrImage back = read_exr(file());
  EXPECT_EQ(back.channels, image.channels);
  EXPECT_TRUE(same_bits(back.pixels, image.pixels));
}

TEST_F(ExrParts, HaveTypesOfTheirOwn) {
  write_headers(file(), {part("a", {"R"}, Imf::HALF), part("b", {"R"}, Imf::UINT)});
  std::vector<std::uint32_t> ids(kWidth * kHeight, 0xffffffff);
  std::vector<float> reds(kWidth * kHeight, 0.5f);
  {
    const std::vector<Imf::Header> headers{part("a", {"R"}, Imf::HALF), part("b", {"R"}, Imf::UINT)};
    Imf::MultiPartOutputFile out(file().c_str(), headers.data(), 2);
    std::vector<Imath::half> halves(reds.begin(), reds.end());
    for (int p = 0; p < 2; ++p) {
      Imf::FrameBuffer buffer;
      buffer.insert("R", p == 0 ? Imf::Slice::Make(Imf::HALF, halves.data(), headers[0].dataWindow())
                                : Imf::Slice::Make(Imf::UINT, ids.data(), headers[1].dataWindow()));
      Imf::OutputPart to(out, p);
      to.setFrameBuffer(buffer);
      to.writePixels(kHeight);
    }
  }
  const ExrImage image = read_exr(file());
  EXPECT_EQ(image.channels, (std::vector<ExrChannel>{{"R", ExrType::half}, {"b.R", ExrType::uint32}}));
  EXPECT_EQ(*image.integers.at("b.R"), ids);
  EXPECT_TRUE(std::ranges::equal(image.pixels.plane(0), reds));
}

TEST_F(ExrParts, GiveAllTheirMetadataAndTheFirstCountsWhereTheyDiffer) {
  Imf::Header first = part("rgba", {"R"}), second = part("N", {"X"});
  first.insert("owner", Imf::StringAttribute("the first"));
  second.insert("owner", Imf::StringAttribute("the second"));
  second.insert("cryptomatte/1/name", Imf::StringAttribute("N"));
  second.insert("worldToCamera", Imf::M44fAttribute(Imath::M44f(2.0f)));
  write_parts(file(), {first, second});
  const ExrImage image = read_exr(file());
  EXPECT_EQ(*image.about<std::string>("owner"), "the first");
  EXPECT_EQ(*image.about<std::string>("cryptomatte/1/name"), "N");
  EXPECT_FALSE(image.metadata.contains("name")) << "how it is stored";
  write_exr(file(), image);
  const Imf::MultiPartInputFile back(file().c_str());
  EXPECT_NE(back.header(0).findTypedAttribute<Imf::M44fAttribute>("worldToCamera"), nullptr);
}

TEST_F(ExrParts, OfOtherPixelsThanTheFirstAreRefused) {
  Imf::Header moved = part("N", {"X"});
  moved.dataWindow() = {{1, 0}, {kWidth, kHeight - 1}};
  const std::string why = refusal({part("rgba", {"R"}), part("P", {"X"}), moved});
  EXPECT_THAT(why, HasSubstr("part 'N' covers pixels 1 0 to 5 2, the first part 0 0 to 4 2"));
  EXPECT_THAT(why, HasSubstr("accepted: parts of one data window"));
}

TEST_F(ExrParts, ThatAreDeepAreRefused) {
  Imf::Header deep = part("smoke", {"Z"});
  deep.setType(Imf::DEEPSCANLINE);
  deep.compression() = Imf::ZIPS_COMPRESSION;
  EXPECT_THAT(refusal({deep}), HasSubstr("part 'smoke' is deep; accepted: flat images"));
  EXPECT_THAT(refusal({part("rgba", {"R"}), deep}), HasSubstr("part 'smoke' is deep; accepted: flat images"));
}

TEST_F(ExrParts, WhoseChannelsWouldHaveOneNameAreRefused) {
  const std::string why = refusal({part("rgba", {"R", "N.X"}), part("N", {"X", "Y"})});
  EXPECT_THAT(why, HasSubstr("part 'rgba' and part 'N' both have a channel 'N.X'"));
  EXPECT_THAT(why, HasSubstr("accepted: another name for each"));
  EXPECT_THAT(refusal({part("rgba", {"R"}), part("a", {"N.X"}), part("b", {"N.X"})}),
              HasSubstr("part 'a' and part 'b'"));
  const std::string longest(254, 'n');
  EXPECT_THAT(refusal({part("rgba", {"R"}), part(longest, {"X"})}), HasSubstr("at most 255 letters"))
      << "OpenEXR cuts names, and two may become one";
}

TEST_F(ExrParts, HaveTheLimitsOfOneImageTogether) {
  write_parts(file(), {part("rgba", {"R"}), part("N", {"X"})});
  EXPECT_NO_THROW(read_exr(file(), 2 * kWidth * kHeight));
  EXPECT_THAT(error_of([&] { read_exr(file(), 2 * kWidth * kHeight - 1); }), HasSubstr("holds 30 values"));
  std::vector<std::string> names;
  for (int i = 0; i < 513; ++i) names.push_back(fmt::format("c{}", i));
  EXPECT_THAT(refusal({part("a", names), part("b", names)}), HasSubstr("has 1026 channels"));

  std::vector<Imf::Header> large{part("a", {"R"}), part("b", {"R"})};
  for (Imf::Header& header : large) {
    header.dataWindow() = header.displayWindow() = {{0, 0}, {32767, 16383}};
    header.compression() = Imf::DWAB_COMPRESSION;
  }
  large[0].insert("padding", Imf::StringAttribute(std::string(10000, 'p')));
  EXPECT_THAT(refusal(large), HasSubstr("claims 1073741824 values"))
      << "a half of which its bytes could hold";
}

TEST_F(ExrParts, OfWhichThereAreTooManyAreRefused) {
  std::vector<Imf::Header> many;
  for (int i = 0; i < 1025; ++i) many.push_back(part(fmt::format("p{}", i), {"R"}));
  EXPECT_THAT(refusal(many), HasSubstr("too many parts; accepted: 1 to 1024"));
}

// The header of the second part begins behind what a file's start usually has.
TEST_F(ExrParts, WhoseHeadersAreLongAreLookedAtToTheEnd) {
  Imf::Header first = part("rgba", {"R"}), second = part("N", {"X"});
  first.insert("manifest", Imf::StringAttribute(std::string(5 << 20, 'm')));
  second.insert("ours", Imf::StringAttribute("four"));
  write_parts(file(), {first, second});
  EXPECT_EQ(read_exr(file()).channels.size(), 2u);
  std::string bytes = bytes_of(file());
  const std::string size("ours\0string\0", 12);
  bytes.replace(bytes.find(size) + size.size(), 4, "\xff\xff\xff\x7f", 4);
  std::ofstream(file(), std::ios::binary) << bytes;
  EXPECT_THAT(error_of([&] { read_exr(file()); }), HasSubstr("its header promises more than it holds"));
}

// Whatever bytes are turned, the answer is an image or an InputError.
TEST_F(ExrParts, ThatAreDamagedCostAnInputErrorAndNothingMore) {
  write_parts(file(), {part("rgba", {"R", "G"}), tiled(part("N", {"X"})), part("id", {"Y"})});
  const std::string good = bytes_of(file());
  int refused = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    std::string bad = good;
    for (unsigned i = 0; i <= random() % 4; ++i) bad[random() % bad.size()] = static_cast<char>(random());
    if (random() % 5 == 0) bad.resize(random() % bad.size());
    std::ofstream(file("bad.exr"), std::ios::binary) << bad;
    try {
      read_exr(file("bad.exr"));
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace tessera
