// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "cli/walk.h"
#include "cli/worse.h"
#include "core/layers.h"
#include "tests/cli/denoise_fixture.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Denoise : public DenoiseFixture {
 protected:
  // A noisy picture with all that atrous takes.
  ExrImage picture(unsigned seed = 1) const {
    const Region region{0, 0, 40, 30};
    ExrImage image;
    image.display = region;
    const std::vector<Channel> inputs = parse_filter("atrous").inputs();
    image.pixels = Image(region, static_cast<int>(inputs.size()) + 1, 0.5f);
    std::minstd_rand random(seed);
    for (float& v : image.pixels.data()) v += 0.2f * std::uniform_real_distribution<float>(-1, 1)(random);
    for (const Channel& c : inputs) {
      std::string name = file_channel(c);
      if (c.aov == Aov::color) name = name.substr(name.find('.') + 1);  // as others call it
      image.channels.push_back({name, ExrType::float32});
    }
    image.channels.push_back({"mask.Y", ExrType::float32});
    image.metadata["owner"] = "somebody";
    return image;
  }
};

TEST_F(Denoise, ReplacesThePictureAndKeepsAllElse) {
  write("in.exr", picture());
  EXPECT_EQ(run(options("in.exr", "out.exr")), 0);
  const ExrImage in = read_exr(path("in.exr")), out = read_exr(path("out.exr"));
  EXPECT_EQ(in.channels, out.channels);
  for (const ExrChannel& c : in.channels) {
    const bool same =
        std::ranges::equal(in.pixels.plane(in.plane(c.name)), out.pixels.plane(out.plane(c.name)));
    EXPECT_EQ(same, c.name != "R" && c.name != "G" && c.name != "B") << c.name;
  }
  EXPECT_EQ(std::get<std::string>(out.metadata.at("owner")), "somebody");
  EXPECT_EQ(std::get<std::string>(out.metadata.at("tessera/filter")), "atrous:levels=2");
  EXPECT_TRUE(fs::exists(path("out.png")));
}

TEST_F(Denoise, KeepsIntegersAndInfinitiesToTheBit) {
  ExrImage in = picture();
  const std::vector<std::uint32_t> ids(in.pixels.region().area(), 0xfffffffe);
  const int id = in.plane("mask.Y"), sky = in.plane("Z");
  in.channels[static_cast<std::size_t>(id)] = {"id.Y", ExrType::uint32};
  std::ranges::fill(in.pixels.plane(id), static_cast<float>(ids[0]));
  in.integers["id.Y"] = std::make_shared<const std::vector<std::uint32_t>>(ids);
  in.channels[static_cast<std::size_t>(sky)].type = ExrType::half;
  in.pixels.at(sky, 3, 4) = std::numeric_limits<float>::infinity();
  write("in.exr", in);
  EXPECT_EQ(run(options("in.exr", "out.exr")), 0);
  const ExrImage out = read_exr(path("out.exr"));
  EXPECT_EQ(out.channels, read_exr(path("in.exr")).channels);
  ASSERT_TRUE(out.integers.contains("id.Y"));
  EXPECT_EQ(*out.integers.at("id.Y"), ids);
  EXPECT_EQ(out.pixels.at(out.plane("Z"), 3, 4), std::numeric_limits<float>::infinity());
}

TEST_F(Denoise, DoesNotDependOnTheMemoryThatTilesMayTake) {
  ExrImage large = picture();
  large.display = {0, 0, 400, 300};
  large.pixels = Image(large.display, large.pixels.planes());
  std::minstd_rand random(3);
  for (float& v : large.pixels.data()) v = std::uniform_real_distribution<float>(0.1f, 1)(random);
  write("in.exr", large);
  DenoiseOptions o = options("in.exr", "whole.exr"), small = options("in.exr", "tiles.exr");
  small.memory = 2;
  EXPECT_EQ(run(o), 0);
  EXPECT_EQ(run(small), 0);
  EXPECT_THAT(out_, testing::Not(HasSubstr("400x300"))) << "it is cut into tiles";
  EXPECT_TRUE(same_bits(read_exr(path("whole.exr")).pixels, read_exr(path("tiles.exr")).pixels));
}

TEST_F(Denoise, TilesAreAsLargeAsTheMemoryAllowsOrSayWhatTheyNeed) {
  const FilterPlan plan = parse_filter("atrous");  // 62 px of halo
  const Region frame{0, 0, 1000, 600};
  EXPECT_EQ(tile_within(plan, frame, std::uint64_t{1} << 40), (Size{1000, 600}));
  EXPECT_EQ(tile_within(plan, frame, std::uint64_t{1} << 40, {256, 128}), (Size{256, 128}));
  const Size cut = tile_within(plan, frame, 30 << 20);
  EXPECT_LT(cut.width, 1000);
  EXPECT_GE(cut.width, 250) << "not smaller than need be";
  try {
    tile_within(plan, frame, 1 << 20);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::out_of_memory);
    EXPECT_THAT(e.what(), HasSubstr("MiB for a tile of"));
  }
}

TEST_F(Denoise, GoesThroughASequenceAndLosesNoFrameForAnother) {
  for (const int f : {1, 2, 4})
    write("in.000" + std::to_string(f) + ".exr", picture(static_cast<unsigned>(f)));
  std::ofstream(path("in.0003.exr")) << "no EXR";
  EXPECT_EQ(run(options("in.####.exr", "out.####.exr")), static_cast<int>(ExitCode::bad_input));
  EXPECT_THAT(problems_, HasSubstr("frame 3: "));
  for (const int f : {1, 2, 4}) EXPECT_TRUE(fs::exists(path("out.000" + std::to_string(f) + ".exr"))) << f;
  EXPECT_FALSE(fs::exists(path("out.0003.exr")));

  DenoiseOptions some = options("in.%04d.exr", "some.##.exr");
  some.frames = "1-4x3";
  EXPECT_EQ(run(some), 0);
  EXPECT_TRUE(fs::exists(path("some.04.exr")));
  EXPECT_FALSE(fs::exists(path("some.02.exr")));
  DenoiseOptions none = options("in.####.exr", "none.####.exr");
  none.frames = "";
  EXPECT_EQ(error_of(none).code(), ExitCode::bad_usage) << "a script whose variable is empty wants no frames";
  EXPECT_FALSE(fs::exists(path("none.0001.exr")));
}

TEST_F(Denoise, EndsWithTheCodeOfTheWorstFrameAndNotOfTheLast) {
  using enum ExitCode;
  EXPECT_EQ(worse(done, stopped_at_limit), stopped_at_limit);
  EXPECT_EQ(worse(stopped_at_limit, out_of_memory), out_of_memory);
  EXPECT_EQ(worse(out_of_memory, bad_input), out_of_memory) << "the first of two failures";
  EXPECT_EQ(worse(bad_input, stopped_at_limit), bad_input);
  EXPECT_EQ(worse(bad_input, interrupted), interrupted);
  EXPECT_EQ(worse(interrupted, bad_input), interrupted);

  ExrImage large = picture();
  large.display = {0, 0, 400, 300};
  large.pixels = Image(large.display, large.pixels.planes(), 0.5f);
  write("in.1.exr", large);
  std::ofstream(path("in.2.exr")) << "no EXR";
  DenoiseOptions o = options("in.#.exr", "out.#.exr");
  o.filter = "atrous";
  o.memory = 1;
  EXPECT_EQ(run(o), static_cast<int>(out_of_memory)) << problems_;
}

TEST_F(Denoise, TakesGuidesFromFilesOfTheirOwn) {
  ExrImage whole = picture();
  write("in.exr", whole);
  EXPECT_EQ(run(options("in.exr", "whole.exr")), 0);
  ExrImage albedo;
  albedo.display = whole.display;
  albedo.pixels = Image(whole.display, 3);
  for (int c = 0; c < 3; ++c) {
    const std::string name = std::string("albedo.") + "RGB"[c];
    const int plane = whole.plane(name);
    std::ranges::copy(whole.pixels.plane(plane), albedo.pixels.plane(c).begin());
    albedo.channels.push_back({std::string(1, "RGB"[c]), ExrType::float32});
    whole.channels[static_cast<std::size_t>(plane)].name = "other." + std::to_string(c);
  }
  write("in.exr", whole);
  write("albedo.exr", albedo);
  EXPECT_THAT(error_of(options("in.exr", "parts.exr")).what(), HasSubstr("albedo.RGB"));
  DenoiseOptions o = options("in.exr", "parts.exr");
  o.guides = {"albedo=" + path("albedo.exr")};
  EXPECT_EQ(run(o), 0);
  const ExrImage a = read_exr(path("whole.exr")), b = read_exr(path("parts.exr"));
  for (const char* c : {"R", "G", "B"})
    EXPECT_TRUE(std::ranges::equal(a.pixels.plane(a.plane(c)), b.pixels.plane(b.plane(c))));
}

TEST_F(Denoise, SaysWhichGuideTheFilterDoesNotTake) {
  write("in.exr", picture());
  DenoiseOptions o = options("in.exr", "out.exr");
  o.guides = {"shading=" + path("in.exr"), "Z=" + path("in.exr")};
  EXPECT_EQ(run(o), 0);
  EXPECT_THAT(problems_, HasSubstr("filter 'atrous' takes no such layer"));
  EXPECT_THAT(problems_, testing::Not(HasSubstr("--guide Z")));
}

// Parameters do not change within a shot.
TEST_F(Denoise, TakesTheScenesSizeFromTheFirstFrameOfAShotForAllOfThem) {
  for (const int f : {1, 2}) {
    ExrImage frame = picture();
    for (const char* c : {"P.X", "P.Y", "P.Z"})
      for (float& v : frame.pixels.plane(frame.plane(c))) v *= static_cast<float>(f);
    write("in." + std::to_string(f) + ".exr", frame);
  }
  DenoiseOptions o = options("in.#.exr", "out.#.exr");
  o.filter = "guided";
  EXPECT_EQ(run(o), 0);
  const auto filter_of = [&](const char* name) {
    return std::get<std::string>(read_exr(path(name)).metadata.at("tessera/filter"));
  };
  EXPECT_EQ(filter_of("out.1.exr"), filter_of("out.2.exr"));
  o = options("in.2.exr", "alone.exr");
  o.filter = "guided";
  EXPECT_EQ(run(o), 0);
  EXPECT_NE(filter_of("alone.exr"), filter_of("out.2.exr"));
}

TEST_F(Denoise, CountsAndLocatesWhatIsNotFinite) {
  ExrImage in = picture();
  in.pixels.at(in.plane("G"), 7, 11) = std::numeric_limits<float>::quiet_NaN();
  in.pixels.at(in.plane("G"), 9, 12) = std::numeric_limits<float>::infinity();
  write("in.exr", in);
  EXPECT_EQ(run(options("in.exr", "out.exr")), 0);
  EXPECT_THAT(problems_, HasSubstr("noisy.G: 2 pixels are not finite, the first at (7, 11)"));
  const ExrImage out = read_exr(path("out.exr"));
  for (const char* c : {"R", "G", "B"})
    for (const float v : out.pixels.plane(out.plane(c))) ASSERT_TRUE(std::isfinite(v));
}

TEST_F(Denoise, RefusesWhatMakesNoSense) {
  write("in.exr", picture());
  EXPECT_THAT(error_of(options("in.exr", "in.exr")).what(), HasSubstr("is the input itself"));
  EXPECT_EQ(error_of(options("nothing.exr", "out.exr")).code(), ExitCode::bad_input);
  EXPECT_EQ(error_of(options("in.####.exr", "out.exr")).code(), ExitCode::bad_usage) << "one file for many";
  DenoiseOptions o = options("in.exr", "out.exr");
  o.frames = "1-2";
  EXPECT_THAT(error_of(o).what(), HasSubstr("--frames"));
  o = options("in.exr", "out.exr");
  o.guides = {"albedo"};
  EXPECT_THAT(error_of(o).what(), HasSubstr("LAYER=FILE"));
  o.guides = {"albdeo=" + path("in.exr")};
  EXPECT_THAT(error_of(o).what(), HasSubstr("did you mean 'albedo'"));
  o.guides = {"Z=" + path("in.exr"), "Z=" + path("in.exr")};
  EXPECT_THAT(error_of(o).what(), HasSubstr("one file for each layer"));
  DenoiseOptions many = options("in.####.exr", "out.####.exr");
  many.guides = {"albedo=" + path("in.exr")};
  EXPECT_EQ(error_of(many).code(), ExitCode::bad_usage);
  EXPECT_THAT(error_of(many).what(), HasSubstr("as the input is a sequence"));
  EXPECT_THAT(error_of(options("in.exr", "out.png")).what(), HasSubstr("ends in .exr"));
  EXPECT_THAT(error_of(options("in.exr", "out.####.exr")).what(), HasSubstr("a single image"));
  o = options("in.exr", "out.exr");
  o.filter = "atros";
  EXPECT_THAT(error_of(o).what(), HasSubstr("did you mean 'atrous'"));
  o = options("in.exr", "out.exr");
  o.tile_size = "0x5";
  EXPECT_EQ(error_of(o).code(), ExitCode::bad_usage);
  EXPECT_FALSE(fs::exists(path("out.exr")));
}

}  // namespace
}  // namespace tessera
