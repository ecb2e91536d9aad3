// SPDX-License-Identifier: Apache-2.0
#include "cli/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "core/error.h"
#include "core/exr.h"
#include "core/quality/metrics.h"

namespace tessera {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

const Region kFrame{0, 0, 96, 64};

class Compare : public testing::Test {
 protected:
  Compare()
      : folder_(fs::path(testing::TempDir()) / ("tessera-compare" + std::to_string(std::random_device{}()))) {
    fs::create_directories(folder_);
  }
  ~Compare() override { fs::remove_all(folder_); }

  fs::path file(const std::string& name) const { return folder_ / name; }

  // Channels that hold `value` in every pixel, as floats.
  fs::path write(const std::string& name, float value, const std::string& channels = "RGB",
                 const Region& region = kFrame, const std::string& tile = "") const {
    ExrImage image{region, Image(region, static_cast<int>(channels.size()), value), {}, {}};
    for (char c : channels) image.channels.push_back({std::string(1, c), false});
    if (!tile.empty()) image.metadata["tessera/tile"] = tile;
    write_exr(file(name), image);
    return file(name);
  }

  static std::string output(const CompareOptions& options) {
    std::ostringstream out;
    EXPECT_EQ(compare(options, out), 0);
    return out.str();
  }
  static std::string error(const CompareOptions& options) {
    std::ostringstream out;
    try {
      compare(options, out);
    } catch (const InputError& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      EXPECT_EQ(out.str(), "") << "nothing is said before all is known";
      return e.what();
    }
    return "no InputError";
  }

 private:
  fs::path folder_;
};

TEST_F(Compare, TellsTheMetricsAsJson) {
  CompareOptions options{write("x.exr", 0.6f, "ABGR"), write("r.exr", 0.5f)};
  options.json = true;
  options.tile_size = "32x16";
  const auto j = nlohmann::json::parse(output(options));
  EXPECT_NEAR(j["relmse"], 0.01 / 0.26, 1e-7);
  EXPECT_NEAR(j["relmse_trimmed"], 0.01 / 0.26, 1e-7);
  EXPECT_NEAR(j["rmse"], 0.1, 1e-7);
  EXPECT_NEAR(j["ssim"], ssim(Image(kFrame, 3, 0.6f), Image(kFrame, 3, 0.5f)), 1e-12);
  EXPECT_EQ(j["seam"], 1.0);
  EXPECT_EQ(j["tile"], (std::vector<int>{32, 16}));
  EXPECT_EQ(j["width"], 96);
  EXPECT_FALSE(j.contains("heat_map_scale"));
}

TEST_F(Compare, TellsTheMetricsAsAnAlignedTable) {
  CompareOptions options{write("x.exr", 0.6f), write("r.exr", 0.5f)};
  options.exposure = -1;
  std::istringstream lines(output(options));
  std::string line;
  for (const char* name : {"relMSE ", "relMSE trimmed ", "RMSE ", "SSIM ", "seam "}) {
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_THAT(line, testing::StartsWith(name));
    EXPECT_EQ(line.substr(28, 2), "  ") << "the numbers end in one column: " << line;
  }
  EXPECT_FALSE(std::getline(lines, line));
  EXPECT_THAT(output(options), HasSubstr("exposure -1"));
}

TEST_F(Compare, TakesTheTileSizeFromTheImageUnlessTold) {
  CompareOptions options{write("x.exr", 0.6f, "RGB", kFrame, "32"), write("r.exr", 0.5f)};
  EXPECT_THAT(output(options), HasSubstr("tiles of 32 x 32"));
  options.tile_size = "16x8";
  EXPECT_THAT(output(options), HasSubstr("tiles of 16 x 8"));
  options.image = options.reference;
  options.tile_size.clear();
  EXPECT_THAT(output(options), HasSubstr("tiles of 256 x 256"));
  options.image = write("odd.exr", 0.6f, "RGB", kFrame, "many");
  EXPECT_THAT(error(options), HasSubstr("odd.exr: tessera/tile: 'many'"));
}

TEST_F(Compare, CountsWhatIsNotFiniteAndSaysNullInJson) {
  CompareOptions options{write("x.exr", std::nanf("")), write("r.exr", 0.5f)};
  EXPECT_THAT(output(options), HasSubstr("not finite: 6144 pixels of the image, 0 of the reference"));
  options.json = true;
  const auto j = nlohmann::json::parse(output(options));
  EXPECT_TRUE(j["relmse"].is_null());
  EXPECT_EQ(j["not_finite"]["image"], 6144);
}

TEST_F(Compare, WritesAHeatMapAndItsScale) {
  CompareOptions options{write("x.exr", 0.6f), write("r.exr", 0.5f)};
  options.heat_map = file("heat.png");
  EXPECT_THAT(output(options), HasSubstr("0 (black) to 0.05 (yellow)"));  // relMSE is 0.038
  EXPECT_TRUE(fs::exists(options.heat_map));
  options.image = options.reference;
  EXPECT_THAT(output(options), HasSubstr("0 (black) to 0 (yellow)"));
}

TEST_F(Compare, RefusesImagesThatCannotBeCompared) {
  const fs::path good = write("good.exr", 1.0f);
  EXPECT_THAT(error({write("size.exr", 1.0f, "RGB", {0, 0, 96, 63}), good}),
              HasSubstr("96 x 63 pixels at (0, 0)"));
  EXPECT_THAT(error({write("moved.exr", 1.0f, "RGB", {1, 0, 97, 64}), good}), HasSubstr("at (1, 0)"));
  EXPECT_THAT(error({good, write("grey.exr", 1.0f, "RG")}),
              HasSubstr("grey.exr: has not all of the channels R, G and B"));
  EXPECT_THAT(error({file("none.exr"), good}), HasSubstr("none.exr"));
  CompareOptions tiles{good, good};
  tiles.tile_size = "0x9";
  EXPECT_THAT(error(tiles), HasSubstr("--tile-size: '0x9'"));
  CompareOptions nowhere{good, good};
  nowhere.heat_map = file("no/folder.png");
  EXPECT_THAT(error(nowhere), HasSubstr("folder.png"));
}

TEST_F(Compare, ReadsItsOptionsFromTheCommandLine) {
  CompareOptions options;
  CLI::App app;
  describe(app, options);
  app.parse("a.exr b.exr --tile-size 64 --exposure 2.5 --heat-map h.png --json");
  EXPECT_EQ(options.image, "a.exr");
  EXPECT_EQ(options.reference, "b.exr");
  EXPECT_EQ(options.tile_size, "64");
  EXPECT_EQ(options.exposure, 2.5f);
  EXPECT_EQ(options.heat_map, "h.png");
  EXPECT_TRUE(options.json);
  EXPECT_THROW(app.parse("a.exr"), CLI::ParseError);
}

TEST(TileSize, IsANumberOrTwo) {
  EXPECT_EQ(parse_tile_size("64"), (Size{64, 64}));
  EXPECT_EQ(parse_tile_size("37x53"), (Size{37, 53}));
  EXPECT_EQ(parse_tile_size("65536x1"), (Size{65536, 1}));
  for (const char* bad :
       {"", "x", "0", "-4", "64x", "x64", "64x64x64", "64 x 64", "65537", "1e3", "99999999999"})
    EXPECT_FALSE(parse_tile_size(bad)) << bad;
}

}  // namespace
}  // namespace tessera
