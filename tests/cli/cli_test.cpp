// SPDX-License-Identifier: Apache-2.0
// The program as people meet it: exit codes, messages, files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

#include "core/exr.h"
#include "tests/cli/program.h"

namespace tessera {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(Program, RendersUntilAcceptedAndWritesLayersAndWhatItKnows) {
  const Outcome outcome = run({"render", furnace_, "-o", path("f.exr"), "--width", "70", "--height", "66",
                               "--until", "0.01", "--seed", "5"});
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("accepted: relMSE"));
  EXPECT_THAT(outcome.text, HasSubstr("Progress: 100.0%"));
  EXPECT_TRUE(fs::exists(path("f.png")));
  const ExrImage image = read_exr(path("f.exr"));
  for (const char* channel : {"R", "A", "noisy.G", "variance.B", "samples.Y", "error.Y", "albedo.R", "N.X",
                              "Z", "direct.G", "indirect.B", "emission.R"})
    EXPECT_GE(image.plane(channel), 0) << channel;
  EXPECT_EQ(image.display, (Region{0, 0, 70, 66}));
  for (const char* name :
       {"tessera/version", "tessera/scene", "tessera/samples", "tessera/error", "tessera/filter",
        "tessera/device", "tessera/seconds", "tessera/relmse", "tessera/relmse_upper"})
    EXPECT_TRUE(image.metadata.contains(name)) << name;
  EXPECT_EQ(std::get<std::string>(image.metadata.at("tessera/seed")), "5");
  EXPECT_EQ(files(), 2u);
}

TEST_F(Program, AnUnreachableTargetIsExitCode8WithTheImage) {
  const Outcome outcome = run({"render", cornell_, "-o", path("c.exr"), "--width", "40", "--height", "40",
                               "--until", "relmse=1e-7", "--samples", "16"});
  EXPECT_EQ(outcome.code, 8) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("max_samples"));
  EXPECT_NO_THROW(read_exr(path("c.exr")));
}

TEST_F(Program, ATimeLimitEndsARenderWithTheImageOfTheLastRound) {
  const Outcome outcome = run({"render", cornell_, "-o", path("c.exr"), "--width", "128", "--height", "128",
                               "--until", "1e-9", "--samples", "1048576", "--time", "1"});
  EXPECT_EQ(outcome.code, 8) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("max_seconds"));
}

TEST_F(Program, AnInterruptWritesWhatThereIsAndIsExitCode130) {
  const auto interrupt = [sent = false](pid_t child, const std::string& line) mutable {
    if (line.find(R"("round":3)") != std::string::npos && !std::exchange(sent, true)) kill(child, SIGINT);
  };
  const Outcome outcome = run({"render", cornell_, "-o", path("c.exr"), "--width", "64", "--height", "64",
                               "--until", "1e-9", "--samples", "1048576", "--progress", "json"},
                              interrupt);
  EXPECT_EQ(outcome.code, 130) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("interrupted"));
  EXPECT_NO_THROW(read_exr(path("c.exr")));
}

TEST_F(Program, ACropIsADataWindowInTheWholeFrame) {
  const Outcome outcome =
      run({"render", furnace_, "-o", path("f.exr"), "--width", "64", "--height", "32", "--crop", "0.25",
           "0.5", "0.75", "1", "--samples", "8", "--filter", "none", "--quiet"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.text, "");
  const ExrImage image = read_exr(path("f.exr"));
  EXPECT_EQ(image.display, (Region{0, 0, 64, 32}));
  EXPECT_EQ(image.pixels.region(), (Region{16, 16, 48, 32}));
}

TEST_F(Program, BadScenesAreExitCode3WithPlaceAndReasonAndLeaveNothing) {
  expect_bad_input(path("none.json"), "none.json");
  expect_bad_input(write("a.json", "{ \"name\": \n  oops }"), "a.json:2:");
  expect_bad_input(write("b.json", R"({"camra": {}})"), "camera");
  expect_bad_input(write("c.json", R"({"spheres": [{"center": [0, 0, 0], "radius": -1}]})"),
                   "/spheres/0/radius");
  expect_bad_input(write("d.json", R"({"spheres": [{"center": [0, 0, NaN], "radius": 1}]})"), "d.json:1:");
  expect_bad_input(write("e.json", R"({"import": [{"file": "gone.obj"}]})"), "gone.obj");
  expect_bad_input(write("f.glb", "glTF but not really"), "f.glb");
  expect_bad_input(write("g.obj", "f 1 2 3\n"), "g.obj");
  expect_bad_input(write("h.txt", "hello"), "h.txt");
  write("bad.png", "\x89PNG\r\n\x1a\nrubbish");
  expect_bad_input(write("i.json", R"({"spheres": [{"center": [0, 0, 0], "radius": 1, "material": "m"}],
      "materials": {"m": {"color_texture": "bad.png"}}})"),
                   "bad.png");
}

TEST_F(Program, BadUsageIsExitCode2AndSaysWhatIsAccepted) {
  const auto expect_usage = [&](std::vector<std::string> arguments, const std::string& accepted) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr(accepted));
    EXPECT_EQ(files(), 0u);
  };
  const auto render = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"render", furnace_, "-o", path("x.exr")});
    return more;
  };
  expect_usage(render({"--width", "0"}), "1 to 65536");
  expect_usage(render({"--height", "-3"}), "1 to 65536");
  expect_usage(render({"--samples", "2000000000"}), "16777216");
  expect_usage(render({"--until", "gud"}), "draft, good, final");
  expect_usage(render({"--until", "relmse=nan"}), "above 0");
  expect_usage(render({"--filter", "svgv"}), "svgf");
  expect_usage(render({"--filter", "svgf:levels=99"}), "1 to");
  expect_usage(render({"--tile-size", "12y"}), "WxH");
  expect_usage(render({"--crop", "0", "0", "2", "1"}), "0 to 1");
  expect_usage(render({"--aov", "beauty"}), "albedo");
  expect_usage(render({"--compression", "bzip"}), "zip");
  expect_usage({"render", furnace_, "-o", path("nowhere/x.exr")}, "nowhere");
  expect_usage({"render", furnace_, "-o", path("x.jpg")}, ".exr");
  expect_usage({"rendr"}, "did you mean 'render'?");
}

TEST_F(Program, SaysThatFewerThanEightSamplesAreNotTaken) {
  const auto said = [&](const char* samples) {
    const Outcome outcome = run(
        {"render", furnace_, "-o", path("x.exr"), "--width", "16", "--height", "16", "--samples", samples});
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    return outcome.text;
  };
  EXPECT_THAT(said("1"), HasSubstr("--samples 1: at least 8 are taken"));
  EXPECT_THAT(said("4"), HasSubstr("--samples 4: at least 8 are taken"));
  EXPECT_THAT(said("8"), testing::Not(HasSubstr("at least")));
}

TEST_F(Program, AFrameThatCannotFitInMemoryIsExitCode4BeforeAnythingIsRendered) {
  const Outcome outcome =
      run({"render", furnace_, "-o", path("x.exr"), "--width", "65536", "--height", "65536"});
  EXPECT_EQ(outcome.code, 4) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("GiB"));
}

TEST_F(Program, AnUnknownDeviceIsExitCode5AndAnUnknownCameraIsExitCode3) {
  EXPECT_EQ(run({"render", furnace_, "-o", path("x.exr"), "--device", "abacus"}).code, 5);
  EXPECT_EQ(run({"render", furnace_, "-o", path("x.exr"), "--camera", "nobody's"}).code, 3);
}

TEST_F(Program, TellsOfAFilterWhatItIsWithTheseParameters) {
  const Outcome still = run({"filters", "svgf"}), moving = run({"filters", "svgf:history=on"});
  EXPECT_THAT(still.text, Not(HasSubstr("numbers of a pixel for the next frame")));
  EXPECT_THAT(moving.text, HasSubstr("numbers of a pixel for the next frame"));
  EXPECT_THAT(moving.text, HasSubstr("motion"));
  EXPECT_THAT(run({"filters"}).text, AllOf(HasSubstr("atrous"), HasSubstr("statmc")));
  EXPECT_EQ(run({"filters", "svg"}).code, 2);
}

TEST_F(Program, EverySubcommandHasHelp) {
  EXPECT_EQ(run({"--version"}).code, 0);
  for (const char* command : {"render", "compare", "scene", "devices", "filters", "schema"}) {
    const Outcome outcome = run({command, "--help"});
    EXPECT_EQ(outcome.code, 0) << command;
    EXPECT_THAT(outcome.text, HasSubstr(command));
  }
}

TEST_F(Program, DenoisesAFileToTheBitsThatRenderingWithTheFilterGives) {
  const std::vector<std::string> common{"--width", "72", "--height", "50", "--samples", "16", "--quiet"};
  for (const std::string filter : {"svgf", "atrous:sigma_c=0.5", "statmc"}) {
    const auto render = [&](const std::string& to, const std::vector<std::string>& how) {
      std::vector<std::string> words{"render", cornell_, "-o", path(to)};
      words.insert(words.end(), common.begin(), common.end());
      words.insert(words.end(), how.begin(), how.end());
      const Outcome outcome = run(words);
      ASSERT_EQ(outcome.code, 0) << outcome.text;
    };
    render("at_once.exr", {"--filter", filter});
    render("noisy.exr", {"--filter", "none", "--layers-for", filter});
    const Outcome outcome = run({"denoise", path("noisy.exr"), "-o", path("afterwards.exr"), "--filter",
                                 filter, "--tile-size", "37x19"});
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_EQ(outcome.text.find("no layer"), std::string::npos) << "nothing stands in for anything\n"
                                                                << outcome.text;
    const ExrImage a = read_exr(path("at_once.exr")), b = read_exr(path("afterwards.exr"));
    for (const char* channel : {"R", "G", "B"})
      EXPECT_TRUE(std::ranges::equal(a.pixels.plane(a.plane(channel)), b.pixels.plane(b.plane(channel))))
          << filter << ' ' << channel;
    EXPECT_EQ(std::get<std::string>(b.metadata.at("tessera/filter")), filter);
    EXPECT_EQ(b.metadata.count("tessera/error"), 0u) << "the noisy picture's error is not this one's";
    EXPECT_GE(b.plane("albedo.R"), 0) << "other layers stay";
  }
}

}  // namespace
}  // namespace tessera
