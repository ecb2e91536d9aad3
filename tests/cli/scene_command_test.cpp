// SPDX-License-Identifier: Apache-2.0
// tessera scene, as people meet it: exit codes, what is printed, what is written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/limit_options.h"
#include "core/error.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SceneCommand : public testing::Test {
 protected:
  SceneCommand() : folder_(fs::path(testing::TempDir()) / ("tessera-scene-" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~SceneCommand() override { fs::remove_all(folder_); }

  struct Outcome {
    int code = -1;
    std::string out, err;
  };
  // The arguments hold no quotes.
  Outcome run(const std::string& arguments) const {
    const fs::path err = folder_ / "stderr.txt";
    FILE* pipe =
        popen(("'" TESSERA_BINARY "' scene " + arguments + " 2> '" + err.string() + "'").c_str(), "r");
    Outcome outcome;
    std::array<char, 4096> buffer;
    for (std::size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
      outcome.out.append(buffer.data(), n);
    const int status = pclose(pipe);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    std::ifstream stream(err);
    outcome.err.assign(std::istreambuf_iterator<char>(stream), {});
    fs::remove(err);
    return outcome;
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  const std::string cornell_ = TESSERA_SOURCE_DIR "/scenes/cornell.json";
  const fs::path folder_;
};

TEST_F(SceneCommand, CheckIsQuietAboutGoodScenesAndEndsWith3ForBadOnes) {
  const Outcome good = run("check " + cornell_);
  EXPECT_EQ(good.code, 0);
  EXPECT_THAT(good.out, HasSubstr("good, 0 warnings"));
  EXPECT_EQ(good.err, "");
  const Outcome warned = run("check " + write("dark.json", R"({"spheres": [{"center": [0, 0, 0]}]})"));
  EXPECT_EQ(warned.code, 0);
  EXPECT_THAT(warned.err, HasSubstr("there is no light"));
  const Outcome bad = run("check " + write("bad.json", R"({"spheres": [{"centre": [0, 0, 0]}]})"));
  EXPECT_EQ(bad.code, 3);
  EXPECT_THAT(bad.err, HasSubstr("bad.json:/spheres/0/centre: unknown key 'centre'; did you mean 'center'?"));
  EXPECT_EQ(run("check").code, 2);
  EXPECT_EQ(run("").code, 2);
}

TEST_F(SceneCommand, InfoCountsTheCornellBox) {
  const Outcome outcome = run("info --json " + cornell_);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto info = nlohmann::json::parse(outcome.out);
  // Four walls and the lamp, the ceiling around it, two blocks without a bottom.
  const int triangles = 2 * (4 + 1 + 4 + 2 * 5);
  EXPECT_EQ(info["triangles"]["unique"], triangles);
  EXPECT_EQ(info["triangles"]["instanced"], triangles);
  EXPECT_EQ(info["lights"]["emissive triangles"], 2) << "the lamp";
  EXPECT_EQ(info["materials"]["diffuse"], 4);
  EXPECT_EQ(info["cameras"].size(), 1u);
  EXPECT_EQ(info["hash"].get<std::string>().size(), 64u);
  const Outcome table = run("info " + cornell_);
  EXPECT_THAT(table.out, HasSubstr("38, 38 with instances"));
  EXPECT_THAT(table.out, HasSubstr(info["hash"].get<std::string>()));
}

TEST_F(SceneCommand, ConvertKeepsTheHash) {
  const Outcome outcome = run("convert " + cornell_ + " " + path("out.json"));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("whole"));
  const auto hash = [&](const std::string& file) {
    return nlohmann::json::parse(run("info --json " + file).out)["hash"];
  };
  EXPECT_EQ(hash(path("out.json")), hash(cornell_));
  EXPECT_EQ(run("convert " + cornell_ + " " + path("out.txt")).code, 2);
  EXPECT_EQ(run("convert " + path("none.json") + " " + path("o.json")).code, 3);
  EXPECT_FALSE(fs::exists(path("o.json")));
}

TEST_F(SceneCommand, LimitsRefuseWithTheirName) {
  const Outcome outcome = run("check --limit vertices=1k --limit triangles=37 " + cornell_);
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("the scene has 38 triangles; accepted: at most 37 (limit triangles)"));
  EXPECT_EQ(run("check --limit triangles=38 " + cornell_).code, 0);
  const Outcome unknown = run("check --limit triangle=36 " + cornell_);
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean 'triangles'?"));
}

TEST(LimitOption, TakesUnits) {
  ImportLimits limits;
  for (const auto& [text, value] : {std::pair<std::string, std::uint64_t>{"vertices=7", 7},
                                    {"vertices=2k", 2000},
                                    {"vertices=3Mi", 3 << 20},
                                    {"vertices=4G", 4'000'000'000}}) {
    parse_limit(text, limits);
    EXPECT_EQ(limits.vertices, value) << text;
  }
  for (const char* text : {"vertices", "vertices=", "vertices=-1", "vertices=1.5", "vertices=2T", "=3",
                           "vertices=18446744073709551615k"})
    EXPECT_THROW(parse_limit(text, limits), Error) << text;
}

}  // namespace
}  // namespace tessera
