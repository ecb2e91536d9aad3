// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "cli/compare.h"
#include "cli/compare_report.h"
#include "core/error.h"
#include "core/exr.h"
#include "core/scene/srgb.h"

namespace tessera {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

const Region kFrame{0, 0, 24, 16};

class CompareSequence : public testing::Test {
 protected:
  CompareSequence()
      : folder_(fs::path(testing::TempDir()) /
                ("tessera-sequence" + std::to_string(std::random_device{}()))) {
    fs::create_directories(folder_);
    options_.image = folder_ / "x.###.exr";
    options_.reference = folder_ / "r.%03d.exr";
    options_.metrics = {"rmse", "psnr"};
  }
  ~CompareSequence() override { fs::remove_all(folder_); }

  void write(const std::string& name, float value, const Region& region = kFrame) const {
    constexpr auto kFloats = ExrType::float32;
    write_exr(folder_ / name,
              {region, Image(region, 3, value), {{"R", kFloats}, {"G", kFloats}, {"B", kFloats}}, {}});
  }
  // Frames 8, 9, 10: the image rises, falls; the reference rises once.
  void write_three() const {
    write("x.008.exr", 0.5f), write("x.009.exr", 0.75f), write("x.010.exr", 0.5f);
    write("r.008.exr", 0.5f), write("r.009.exr", 0.5f), write("r.010.exr", 0.625f);
  }
  std::string output() const {
    std::ostringstream out;
    EXPECT_EQ(compare(options_, out), 0);
    return out.str();
  }
  nlohmann::json json() {
    options_.json = true;
    return nlohmann::json::parse(output());
  }
  std::string error() const {
    std::ostringstream out;
    try {
      compare(options_, out);
    } catch (const Error& e) {
      EXPECT_EQ(out.str(), "");
      return e.what();
    }
    return "no Error";
  }

  fs::path folder_;
  CompareOptions options_;
};

TEST_F(CompareSequence, TellsFramesMeanAndWorst) {
  write_three();
  const auto j = json();
  ASSERT_EQ(j["frames"].size(), 3u);
  const double errors[] = {0, 0.25, 0.125};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(j["frames"][i]["frame"], 8 + i);
    EXPECT_NEAR(j["frames"][i]["rmse"], errors[i], 1e-7);
  }
  EXPECT_NEAR(j["mean"]["rmse"], 0.375 / 3, 1e-7) << "the mean of the roots, not the root of the mean";
  EXPECT_NEAR(j["worst"]["rmse"]["value"], 0.25, 1e-7);
  EXPECT_EQ(j["worst"]["rmse"]["frame"], 9);
  EXPECT_EQ(j["worst"]["psnr"]["frame"], 9) << "the least";
}

TEST_F(CompareSequence, TellsTemporalFiguresOfDisplayedValues) {
  write_three();
  const auto j = json();
  const double up = to_srgb(0.75f) - to_srgb(0.5f), moved = to_srgb(0.625f) - to_srgb(0.5f);
  EXPECT_FALSE(j["frames"][0].contains("temporal"));
  EXPECT_NEAR(j["frames"][1]["temporal"], up, 1e-6);
  EXPECT_NEAR(j["frames"][1]["temporal_residual"], up, 1e-6);
  EXPECT_NEAR(j["frames"][2]["temporal_reference"], moved, 1e-6);
  EXPECT_NEAR(j["frames"][2]["temporal_residual"], up + moved, 1e-6);
  EXPECT_NEAR(j["mean"]["temporal"], up, 1e-6);
  EXPECT_NEAR(j["mean"]["temporal_residual"], up + moved / 2, 1e-6);
  EXPECT_NEAR(j["over_frames"]["temporal_relative"], (2 * up - moved) / moved, 1e-5);
  EXPECT_NEAR(j["over_frames"]["deviation"], up / std::sqrt(3), 1e-6);  // of 0, u, 0: u sqrt(2/3 / 2)
  EXPECT_NEAR(j["over_frames"]["deviation_reference"], moved / std::sqrt(3), 1e-6);
  EXPECT_THAT(j["domains"]["temporal"].get<std::string>(), testing::StartsWith("sRGB, exposure +0"));
}

TEST_F(CompareSequence, TellsThemAsATextAndAsCsv) {
  write_three();
  const std::string text = output();
  EXPECT_THAT(text, HasSubstr("3 frames                   mean        worst   frame\n"));
  EXPECT_THAT(text, HasSubstr("RMSE                      0.125         0.25       9  linear\n"));
  EXPECT_THAT(text, HasSubstr("\nframe           rmse"));
  EXPECT_THAT(text, HasSubstr("\n9               0.25"));
  options_.csv = true;
  EXPECT_THAT(output(), HasSubstr("\nsequence,,0,0,24,16,rmse,mean,0.125,linear,,\"\"\n"
                                  "sequence,9,0,0,24,16,rmse,worst,0.25,linear,,\"\"\n"));
  EXPECT_THAT(output(), HasSubstr("\nimage,10,0,0,24,16,rmse,value,0.125,linear,,\"\"\n"));
}

TEST_F(CompareSequence, NamesEveryMissingFrame) {
  for (const char* frame : {"001", "004", "005", "009"}) write("x." + std::string(frame) + ".exr", 1);
  for (int f = 1; f < 9; ++f) write("r.00" + std::to_string(f) + ".exr", 1);
  EXPECT_THAT(error(), HasSubstr("frames are missing: 2-3, 6-8 of "));
  EXPECT_THAT(error(), HasSubstr("x.###.exr, and 9 of "));
  options_.frames = "4-5";
  EXPECT_THAT(output(), HasSubstr("2 frames"));
  options_.frames = "8-11";
  EXPECT_THAT(error(), HasSubstr("8, 10-11 of "));
}

TEST_F(CompareSequence, TakesOneReferenceForAllFrames) {
  write_three();
  options_.reference = folder_ / "r.008.exr";
  EXPECT_EQ(json()["over_frames"]["deviation_reference"], 0.0);
}

TEST_F(CompareSequence, WritesAMapOfEachFrameOnOneScale) {
  write_three();
  options_.maps = {{"rmse", folder_ / "map.##.png"}};
  options_.frames = "9-10";
  options_.sheet = folder_ / "sheet.#.png";
  const auto j = json();
  for (const char* name : {"map.09.png", "map.10.png", "sheet.9.png"})
    EXPECT_TRUE(fs::exists(folder_ / name)) << name;
  EXPECT_NEAR(j["frames"][0]["maps"][0]["high"], 0.5, 1e-6);
  EXPECT_NEAR(j["frames"][1]["maps"][0]["high"], 0.5, 1e-6) << "that of the first frame";
  options_.maps = {{"rmse", folder_ / "map.png"}};
  EXPECT_THAT(error(), HasSubstr("--map: "));
}

TEST_F(CompareSequence, TakesAFileOfJustThatNameForOneImage) {
  write("x#1.exr", 1);
  options_.image = options_.reference = folder_ / "x#1.exr";
  EXPECT_FALSE(json().contains("frames"));
}

TEST_F(CompareSequence, TakesFramesInTheirOrder) {
  write_three();
  options_.frames = "10,8";
  const auto j = json();
  ASSERT_EQ(j["frames"].size(), 2u);
  EXPECT_EQ(j["frames"][0]["frame"], 8);
  EXPECT_EQ(j["frames"][1]["temporal"], 0.0) << "from frame 8, the one before among those chosen";
}

TEST_F(CompareSequence, RefusesWhatIsNoSequence) {
  EXPECT_THAT(error(), HasSubstr("no file has such a name"));
  write_three();
  options_.frames = "9-8";
  EXPECT_THAT(error(), HasSubstr("frames: '9-8'"));
  options_.frames = "8";
  options_.image = folder_ / "x.008.exr";
  EXPECT_THAT(error(), HasSubstr("is a sequence, but"));
  options_.reference = options_.image;
  EXPECT_THAT(error(), HasSubstr("--frames: "));
  options_.frames.clear();
  options_.image = folder_ / "x.###.exr";
  write("x.009.exr", 1, {0, 0, 24, 17});
  options_.reference = folder_ / "r.%03d.exr";
  write("r.009.exr", 1, {0, 0, 24, 17});
  EXPECT_THAT(error(), HasSubstr("24 x 17 pixels")) << "frames of other sizes than the first";
}

TEST(Summaries, HoldNanForTheWorst) {
  SequenceReport s;
  for (const double v : {1.0, std::nan(""), 3.0}) {
    FrameReport frame{.frame = static_cast<int>(s.frames.size())};
    frame.figures.push_back({"rmse", "RMSE", v, "linear", std::nullopt, s.frames.empty() ? "one" : "other"});
    s.frames.push_back(frame);
  }
  const std::vector<Summary> all = summaries(s);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_TRUE(std::isnan(all[0].mean) && std::isnan(all[0].worst));
  EXPECT_EQ(all[0].worst_frame, 1);
  EXPECT_EQ(all[0].figure.remark, "") << "frames differ";
}

}  // namespace
}  // namespace tessera
