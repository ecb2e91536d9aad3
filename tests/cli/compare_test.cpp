// SPDX-License-Identifier: Apache-2.0
#include "cli/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "cli/sizes.h"
#include "core/error.h"
#include "core/exr.h"
#include "core/quality/display.h"
#include "core/quality/ssim.h"
#include "core/scene/srgb.h"

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
    for (char c : channels) image.channels.push_back({std::string(1, c), ExrType::float32});
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

  static std::string refusal(const CompareOptions& options) {
    std::ostringstream out;
    try {
      compare(options, out);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_usage);
      return e.what();
    }
    return "no Error";
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
  EXPECT_NEAR(j["ssim"], ssim(displayed(Image(kFrame, 3, 0.6f)), displayed(Image(kFrame, 3, 0.5f))), 1e-12);
  EXPECT_EQ(j["seam"], 1.0);
  EXPECT_EQ(j["tile"], (std::vector<int>{32, 16}));
  EXPECT_EQ(j["width"], 96);
  EXPECT_FALSE(j.contains("maps"));
  EXPECT_NEAR(j["mse0"], 0.03, 1e-7);
  EXPECT_NEAR(j["smape"], 0.1 / 1.11, 1e-7);
  EXPECT_NEAR(j["largest"], 0.1, 1e-7);
  const double step = to_srgb(0.6f) - to_srgb(0.5f);
  EXPECT_NEAR(j["rmse_display"], step, 1e-6);
  EXPECT_NEAR(j["mse0_display"], 3 * step * step, 1e-6);
  EXPECT_NEAR(j["psnr"], -20 * std::log10(step), 1e-4);
  EXPECT_NEAR(j["mse_l"], 116 * 116 * std::pow(std::cbrt(0.6) - std::cbrt(0.5), 2), 1e-3);
  EXPECT_NEAR(j["mse_luv"], j["mse_l"], 1e-3) << "greys have no chroma";
  EXPECT_NEAR(j["flip"], j["flip_percentile_99"], 1e-5) << "a constant difference";
  EXPECT_NEAR(j["flip"], j["flip_weighted_median"], 1e-5);
  EXPECT_GT(j["hdr_flip"], 0);
}

TEST_F(Compare, SaysTheDomainOfEachFigure) {
  CompareOptions options{write("x.exr", 0.6f), write("r.exr", 0.5f)};
  options.display = {Curve::gamma, -1};
  options.json = true;
  const auto j = nlohmann::json::parse(output(options));
  EXPECT_EQ(j["display"], "gamma 2.2");
  EXPECT_EQ(j["exposure"], -1);
  EXPECT_NEAR(j["rmse_display"], std::pow(0.3, 1 / 2.2) - std::pow(0.25, 1 / 2.2), 1e-6);
  EXPECT_EQ(j["domains"]["rmse"], "linear");
  for (const char* key : {"mse0_display", "rmse_display", "psnr", "ssim", "mse_l", "mse_luv", "flip"})
    EXPECT_THAT(j["domains"][key].get<std::string>(), testing::StartsWith("gamma 2.2, exposure -1")) << key;
  for (const char* key : {"relmse", "mse0", "smape", "hdr_flip", "largest", "seam"})
    EXPECT_THAT(j["domains"][key].get<std::string>(), testing::StartsWith("linear")) << key;
}

TEST_F(Compare, TellsChosenMetricsOnly) {
  CompareOptions options{write("x.exr", 0.6f), write("r.exr", 0.5f)};
  options.json = true;
  options.metrics = {"flip", "largest"};
  const auto j = nlohmann::json::parse(output(options));
  EXPECT_TRUE(j.contains("flip") && j.contains("largest"));
  EXPECT_FALSE(j.contains("relmse") || j.contains("ssim") || j.contains("hdr_flip"));
  options.metrics = {"flop"};
  EXPECT_THAT(refusal(options), HasSubstr("--metrics: unknown metric 'flop'; did you mean 'flip'?"));
  options.metrics.clear();
  options.cells = {"psnr"};
  EXPECT_THAT(refusal(options), HasSubstr("--cells: unknown metric 'psnr'"));
}

TEST_F(Compare, TellsTheMetricsAsAnAlignedTable) {
  CompareOptions options{write("x.exr", 0.6f), write("r.exr", 0.5f)};
  options.display.exposure = -1;
  std::istringstream lines(output(options));
  std::string line;
  for (const char* name :
       {"relMSE ", "relMSE trimmed ", "MSE0 ", "MSE0 display ", "RMSE ", "RMSE display ", "PSNR ", "SMAPE ",
        "SSIM ", "CIELUV MSE L ", "CIELUV MSE Luv ", "FLIP ", "FLIP w. median ", "FLIP 99 % ", "HDR-FLIP ",
        "HDR-FLIP w. median ", "HDR-FLIP 99 % ", "largest error ", "seam "}) {
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_THAT(line, testing::StartsWith(name));
    EXPECT_EQ(line.substr(31, 2), "  ") << "the numbers end in one column: " << line;
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
  EXPECT_THAT(output(options), HasSubstr("not finite: 6144 pixels of the image, the first at (0, 0); 0 pixels of the reference"));
  options.json = true;
  const auto j = nlohmann::json::parse(output(options));
  EXPECT_TRUE(j["relmse"].is_null());
  EXPECT_EQ(j["not_finite"]["image"], 6144);
}

TEST_F(Compare, WritesMapsAndTheirScales) {
  CompareOptions options{write("x.exr", 0.6f), write("r.exr", 0.5f)};
  options.maps = {{"relmse", file("heat.png")}, {"flip", file("flip.png")}, {"relmse", file("again.png")}};
  const std::string text = output(options);
  EXPECT_THAT(text, HasSubstr("map of relmse per pixel, 0 (black) to 0.05 (yellow)"));  // relMSE is 0.038
  EXPECT_THAT(text, HasSubstr("map of flip per pixel, 0 (black) to 1 (yellow)"));
  for (const auto& [metric, png] : options.maps) EXPECT_TRUE(fs::exists(png)) << png;
  options.map_scale = 0.25;
  EXPECT_THAT(output(options), HasSubstr("map of flip per pixel, 0 (black) to 0.25 (yellow)"));
  options.map_scale = 0;
  options.image = options.reference;
  EXPECT_THAT(output(options), HasSubstr("0 (black) to 0 (yellow)"));
}

TEST_F(Compare, TellsOfEachCell) {
  CompareOptions options{write("x.exr", 0.6f), write("r.exr", 0.5f)};  // 96 x 64 pixels: two cells
  options.cells = {"mse0"};
  EXPECT_THAT(output(options), HasSubstr("cells, mse0 (linear)"));
  options.json = true;
  const auto cells = nlohmann::json::parse(output(options))["cells"]["mse0"];
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells[1]["x0"], 64);
  EXPECT_EQ(cells[1]["x1"], 96);
  for (const char* key : {"mean", "percentile_99", "worst_block"}) EXPECT_NEAR(cells[1][key], 0.03, 1e-7);
}

TEST_F(Compare, WritesOneFigureARowAsCsv) {
  CompareOptions options{write("x.exr", 0.6f), write("r.exr", 0.5f)};
  options.csv = true;
  options.metrics = {"rmse", "psnr"};
  options.cells = {"rmse"};
  std::istringstream lines(output(options));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "scope,frame,x0,y0,x1,y1,metric,statistic,value,domain,exposure,remark");
  std::getline(lines, line);
  EXPECT_THAT(line, testing::MatchesRegex("image,,0,0,96,64,rmse,value,0\\.1[0-9]*,linear,,\"\""));
  std::getline(lines, line);
  EXPECT_THAT(line, testing::MatchesRegex("image,,0,0,96,64,psnr,value,[0-9.]*,sRGB,0,\"dB\""));
  std::getline(lines, line);
  EXPECT_THAT(line, testing::StartsWith("cell,,0,0,64,64,rmse,mean,0.1"));
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
  nowhere.maps = {{"relmse", file("no/folder.png")}};
  EXPECT_THAT(error(nowhere), HasSubstr("folder.png"));
  const fs::path narrow = write("narrow.exr", 1.0f, "RGB", {0, 0, 96, 10});
  CompareOptions small{narrow, narrow};
  EXPECT_THAT(output(small), testing::Not(HasSubstr("-nan")));
  small.maps = {{"ssim", file("ssim.png")}};
  EXPECT_THAT(error(small), HasSubstr("ssim has no pixels in so small an image"));
}

TEST_F(Compare, ReadsItsOptionsFromTheCommandLine) {
  CompareOptions options;
  CLI::App app;
  describe(app, options);
  app.parse(
      "a.exr --metrics flip,ssim b.exr --tile-size 64 --exposure 2.5 --heat-map h.png --map flip f.png --map "
      "ssim s.png "
      "--display gamma --ppd 40 --cells relmse --frames 1-9 --map-scale 2 --json");
  EXPECT_EQ(options.image, "a.exr");
  EXPECT_EQ(options.reference, "b.exr");
  EXPECT_EQ(options.frames, "1-9");
  EXPECT_EQ(options.metrics, (std::vector<std::string>{"flip", "ssim"}));
  EXPECT_EQ(options.cells, (std::vector<std::string>{"relmse"}));
  EXPECT_EQ(options.tile_size, "64");
  EXPECT_EQ(options.display, (Display{Curve::gamma, 2.5f}));
  EXPECT_EQ(options.pixels_per_degree, 40);
  EXPECT_EQ(options.map_scale, 2);
  EXPECT_THAT(options.maps,
              testing::UnorderedElementsAre(std::pair("relmse", "h.png"), std::pair("flip", "f.png"),
                                            std::pair("ssim", "s.png")));
  EXPECT_TRUE(options.json);
  for (const char* bad : {"a.exr", "a.exr b.exr --json --csv", "a.exr b.exr --display rec709",
                          "a.exr b.exr --ppd 0", "a.exr b.exr --map flip"})
    EXPECT_THROW(app.parse(bad), CLI::ParseError) << bad;
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
