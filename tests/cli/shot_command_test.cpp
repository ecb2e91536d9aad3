// SPDX-License-Identifier: Apache-2.0
// Shots as people render them: files, resumption, failure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <map>

#include "core/exr.h"
#include "core/filter/filter.h"
#include "core/layers.h"
#include "tests/cli/program.h"

namespace tessera {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Shots : public Program {
 protected:
  Outcome render(const std::string& frames, const std::vector<std::string>& more = {},
                 const std::function<void(pid_t, const std::string&)>& each_line = {}) const {
    std::vector<std::string> arguments{
        "render", cornell_,   "-o", path("c.####.exr"), "--frames", frames,     "--width",
        "64",     "--height", "48", "--samples",        "8",        "--filter", filter_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, each_line);
  }
  Image picture(int frame) const { return read_exr(path("c.000" + std::to_string(frame) + ".exr")).pixels; }
  bool there(int frame) const { return fs::exists(path("c.000" + std::to_string(frame) + ".exr")); }

  std::string filter_ = "svgf:levels=2,history=on";
};

TEST_F(Shots, AreFilesWithTheNumbersOfTheirFrames) {
  filter_ = "svgf:levels=2";
  const Outcome outcome = render("3-9x3,1");
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  for (const int frame : {1, 3, 6, 9}) {
    ASSERT_TRUE(there(frame)) << frame;
    EXPECT_EQ(
        std::get<int>(read_exr(path("c.000" + std::to_string(frame) + ".exr")).metadata.at("tessera/frame")),
        frame);
  }
  EXPECT_EQ(files(), 8u) << "with their previews, and nothing else";
}

TEST_F(Shots, FramesThatAreThereAreLeftOutAndBrokenOrOtherOnesAreNot) {
  filter_ = "svgf:levels=2";
  render("1-4");
  const Image first = picture(1);
  const auto time_of = [&](int frame) {
    return fs::last_write_time(path("c.000" + std::to_string(frame) + ".exr"));
  };
  std::map<int, fs::file_time_type> before;
  for (int frame = 1; frame <= 4; ++frame) before[frame] = time_of(frame);
  fs::remove(path("c.0002.exr"));
  fs::resize_file(path("c.0003.exr"), fs::file_size(path("c.0003.exr")) / 2);
  const Outcome outcome = render("1-5");
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("2 of 5 frames are there already"));
  EXPECT_EQ(time_of(1), before[1]);
  EXPECT_EQ(time_of(4), before[4]);
  EXPECT_NE(time_of(3), before[3]);
  EXPECT_TRUE(there(2) && there(5));
  EXPECT_THAT(render("1-5").text, HasSubstr("5 of 5 frames are there already"));
  EXPECT_THAT(render("1-5", {"--seed", "7"}).text, Not(HasSubstr("there already"))) << "another image";
  EXPECT_FALSE(same_bits(picture(1), first));
}

TEST_F(Shots, FilesThatLackLayersOrAreOtherwiseCompressedAreMadeAgain) {
  const auto has_all = [&](int frame) {
    const ExrImage file = read_exr(path("c.000" + std::to_string(frame) + ".exr"));
    return std::ranges::all_of(parse_filter(filter_).inputs(),
                               [&](const Channel& c) { return file.plane(file_channel(c)) >= 0; });
  };
  const std::vector<std::string> layers{"--layers-for", filter_},
      fewer{"--layers-for", filter_ + ",variance=spatial"};
  render("1-2", fewer);  // of the same AOVs
  EXPECT_FALSE(has_all(2));
  EXPECT_THAT(render("1-2", fewer).text, HasSubstr("2 of 2 frames are there already"));
  EXPECT_THAT(render("1-2", layers).text, Not(HasSubstr("there already")));
  EXPECT_TRUE(has_all(1) && has_all(2));
  EXPECT_THAT(render("1-2", layers).text, HasSubstr("2 of 2 frames are there already"));

  render("1-2");
  EXPECT_THAT(render("1-2", {"--compression", "piz"}).text, Not(HasSubstr("there already")));
  EXPECT_THAT(render("1-3", {"--compression", "piz"}).text, HasSubstr("2 of 3 frames are there already"));
}

TEST_F(Shots, KilledAtAnyMomentAndTakenUpAgainTheyAreTheSame) {
  const Outcome whole = render("1-5");
  ASSERT_EQ(whole.code, 0) << whole.text;
  std::vector<Image> expected;
  for (int frame = 1; frame <= 5; ++frame) expected.push_back(picture(frame));
  for (const int killed_after : {1, 2, 4}) {
    for (const auto& entry : fs::directory_iterator(folder_)) fs::remove(entry);
    render("1-5", {}, [&](pid_t process, const std::string& line) {
      if (line.ends_with("c.000" + std::to_string(killed_after) + ".exr")) kill(process, SIGKILL);
    });
    ASSERT_TRUE(there(killed_after));
    const Outcome rest = render("1-5");
    EXPECT_EQ(rest.code, 0) << rest.text;
    for (int frame = 1; frame <= 5; ++frame)
      EXPECT_TRUE(same_bits(picture(frame), expected[static_cast<std::size_t>(frame - 1)]))
          << frame << " after " << killed_after;
  }
  // Without what the last frame kept, the shot begins anew, and is still the same.
  fs::remove(path("c.history.exr"));
  fs::remove(path("c.0005.exr"));
  EXPECT_THAT(render("1-5").text, Not(HasSubstr("there already")));
  EXPECT_TRUE(same_bits(picture(5), expected[4]));
  // Somebody else's history is none.
  fs::copy_file(path("c.0001.exr"), path("c.history.exr"), fs::copy_options::overwrite_existing);
  fs::remove(path("c.0005.exr"));
  EXPECT_EQ(render("1-5").code, 0);
  EXPECT_TRUE(same_bits(picture(5), expected[4]));
}

TEST_F(Shots, AreFilteredByDenoiseToTheSameBits) {
  ASSERT_EQ(render("1-3", {"--layers-for", filter_}).code, 0);
  const Outcome outcome = run(
      {"denoise", path("c.####.exr"), "-o", path("d.####.exr"), "--filter", filter_, "--tile-size", "40"});
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  for (const std::string frame : {"0001", "0002", "0003"}) {
    const ExrImage a = read_exr(path("c." + frame + ".exr")), b = read_exr(path("d." + frame + ".exr"));
    for (const char* c : {"R", "G", "B"})
      EXPECT_TRUE(std::ranges::equal(a.pixels.plane(a.plane(c)), b.pixels.plane(b.plane(c)))) << frame << c;
  }
}

TEST_F(Shots, AnInterruptWritesWhatThereIsAndTheFrameIsDoneAgain) {
  const Outcome outcome = render("1-9", {}, [&](pid_t process, const std::string& line) {
    if (line.ends_with("c.0002.exr")) kill(process, SIGINT);
  });
  EXPECT_EQ(outcome.code, 130) << outcome.text;
  EXPECT_FALSE(there(9));
  const Outcome rest = render("1-9");
  EXPECT_EQ(rest.code, 0) << rest.text;
  EXPECT_TRUE(there(9));
}

TEST_F(Shots, ARangeThatIsNoneAndAnOutputWithoutPlaceAreExitCode2) {
  for (const char* frames : {"5-1", "x", "", "1-", "1-9x0", "1-99999999", "-1000000"}) {
    const Outcome outcome = render(frames);
    EXPECT_EQ(outcome.code, 2) << frames << ": " << outcome.text;
    EXPECT_EQ(files(), 0u) << frames;
  }
  const Outcome outcome = run({"render", cornell_, "-o", path("c.exr"), "--frames", "1-2"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text,
              HasSubstr("has no place for frame numbers; accepted: a name such as shot.####.exr"));
  EXPECT_EQ(run({"render", cornell_, "--frame", "1", "--frames", "1-2"}).code, 2);
}

}  // namespace
}  // namespace tessera
