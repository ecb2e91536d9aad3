// SPDX-License-Identifier: Apache-2.0
// `tessera denoise --coordinator`: the files of a run on this machine, to the bit.
#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <thread>

#include "cli/fetching.h"
#include "coordinator/farm/farm.h"
#include "core/sequence.h"
#include "tests/cli/denoise_shot.h"
#include "tests/farm/test_farm.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

// Filters, but for frames of one number.
class Picky : public TaskRunner {
 public:
  explicit Picky(int refused) : refused_(refused) {}
  TaskResult run(const Job& job, const Task& task, const FilterInput& input,
                 const std::atomic<bool>& cancel) override {
    if (job.frame == refused_) throw Error(ExitCode::bad_input, "this one is not liked");
    return runner_->run(job, task, input, cancel);
  }

 private:
  int refused_;
  std::unique_ptr<TaskRunner> runner_ = make_task_runner(
      [](const SceneRef&) -> std::shared_ptr<const Scene> {
        throw Error(ExitCode::internal_error, "a scene is asked for, but nothing is rendered");
      },
      DevicePool::open({}));
};

class DenoiseFarm : public DenoiseShot {
 protected:
  void TearDown() override {
    hands_.clear();
    if (farm_) farm_->stop();
    if (thread_.joinable()) thread_.join();
  }
  // With two workers, who do not like frames of that number.
  void open_farm(int refused = -1) {
    road_ = std::make_unique<ZmqRouter>(context_, std::vector{"ipc://" + path("farm")});
    farm_ = std::make_unique<Farm>(
        *road_,
        FarmOptions{.coordinator = farm::impatient(), .store = path("store"), .memory = 1e9, .version = "0"});
    thread_ = std::thread([this] { farm_->run(); });
    runner_ = std::make_unique<Picky>(refused);
    for (int i = 0; i < 2; ++i)
      hands_.push_back(std::make_unique<farm::Hand>(
          std::make_unique<ZmqDealer>(context_, "ipc://" + path("farm"), "worker-" + std::to_string(i)),
          *runner_));
  }
  DenoiseOptions through_farm(DenoiseOptions o, const std::string& tile = "16") const {
    o.farm.coordinator = "ipc://" + path("farm");
    o.tile_size = tile;
    return o;
  }
  DenoiseOptions still() const {
    DenoiseOptions o = options(name("in", 1), "out.exr");
    o.filter = "bilateral";
    return o;
  }
  // All channels and all that is said of them.
  void expect_same_files(const std::string& a, const std::string& b) const {
    const ExrImage one = read_exr(path(a)), other = read_exr(path(b));
    EXPECT_TRUE(same_bits(one.pixels, other.pixels)) << a << " and " << b;
    EXPECT_EQ(one.channels, other.channels);
    EXPECT_EQ(one.display, other.display);
    EXPECT_EQ(one.metadata, other.metadata);
    EXPECT_TRUE(bytes(fs::path(path(a)).replace_extension(".png")) ==
                bytes(fs::path(path(b)).replace_extension(".png")))
        << "other previews";
  }
  static std::string bytes(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string job() const {
    const auto begin = out_.find("job ") + 4;
    return out_.substr(begin, out_.find(':', begin) - begin);
  }

  ZmqContext context_;
  std::unique_ptr<ZmqRouter> road_;
  std::unique_ptr<Farm> farm_;
  std::unique_ptr<TaskRunner> runner_;
  std::thread thread_;
  std::vector<std::unique_ptr<farm::Hand>> hands_;
};

TEST_F(DenoiseFarm, MakesOfAnImageTheFileThatItIsHereInWhateverTiles) {
  open_farm();
  // Overscan: pixels beyond the picture, on all sides.
  ExrImage noisy = picture(1, {-7, -5, 61, 44});
  noisy.display = {0, 0, 54, 38};
  write("in.exr", noisy);
  for (const char* filter : {"svgf:levels=2", "bilateral", "none", "svgf:history=on"}) {
    DenoiseOptions here = options("in.exr", "here.exr");
    here.filter = filter;
    ASSERT_EQ(run(here), 0) << problems_;
    const std::string said = problems_;
    for (const char* tile : {"16", "33x9", "1000", ""}) {
      DenoiseOptions there = through_farm(here, tile);
      there.output = path("there.exr");
      ASSERT_EQ(run(there), 0) << problems_;
      expect_same_files("here.exr", "there.exr");
      EXPECT_THAT(problems_, HasSubstr(said));
      EXPECT_THAT(out_, HasSubstr("by a farm"));
    }
  }
}

TEST_F(DenoiseFarm, MakesOfAShotTheFilesThatItIsHereWithTheSameGapsAndFailures) {
  open_farm();
  write_shot({1, 2, 4, 5, 7});
  std::ofstream(path(name("in", 6))) << "no EXR";
  write(name("in", 8), picture(8, {0, 0, 32, 24}));
  DenoiseOptions here = shot("here"), there = through_farm(shot("there"), "16x11");
  here.frames = there.frames = "2,4-8";
  here.handles = there.handles = 2;
  EXPECT_EQ(run(here), static_cast<int>(ExitCode::bad_input));
  const std::string said = problems_;
  EXPECT_THAT(said, HasSubstr("frame 7 starts anew: frame 6 failed"));
  EXPECT_EQ(run(there), static_cast<int>(ExitCode::bad_input));
  EXPECT_EQ(problems_, said);
  for (const int f : {2, 4, 5, 7, 8}) expect_same_files(name("here", f), name("there", f));
  for (const int f : {1, 6}) EXPECT_FALSE(this->there("there", f)) << f;
}

TEST_F(DenoiseFarm, AFrameThatFailsThereIsACutAndTheOthersAreWritten) {
  open_farm(3);
  write_shot({1, 2, 3, 4, 5});
  EXPECT_EQ(run(through_farm(shot("there"))), static_cast<int>(ExitCode::job_failed));
  EXPECT_THAT(problems_, HasSubstr("frame 3: this one is not liked"));
  EXPECT_THAT(problems_, HasSubstr("frame 4 starts anew: frame 3 failed"));
  EXPECT_FALSE(there("there", 3));
  std::ofstream(path(name("in", 3))) << "no EXR";
  EXPECT_EQ(run(shot("here")), static_cast<int>(ExitCode::bad_input));
  for (const int f : {1, 2, 4, 5}) expect_same_files(name("here", f), name("there", f));
}

TEST_F(DenoiseFarm, AFrameThatWasReadForItsHistoryAloneMayFail) {
  open_farm(1);
  write_shot({1, 2});
  DenoiseOptions o = through_farm(shot("there"));
  o.frames = "2";
  o.handles = 1;
  EXPECT_EQ(run(o), 0);
  EXPECT_THAT(problems_, HasSubstr("frame 2 starts anew: frame 1 failed"));
  EXPECT_TRUE(same_bits(rgb("there", 2), single(2)));
}

TEST_F(DenoiseFarm, GoesBothWaysToTheSameFiles) {
  open_farm();
  write_shot({1, 2, 3, 4, 6});
  DenoiseOptions here = shot("here");
  here.both_ways = true;
  here.frames = "2-3,6";
  here.handles = 1;
  DenoiseOptions there = through_farm(here);
  there.output = path("there.####.exr");
  EXPECT_EQ(run(here), 0) << problems_;
  EXPECT_EQ(run(there), 0) << problems_;
  for (const int f : {2, 3, 6}) expect_same_files(name("here", f), name("there", f));
}

TEST_F(DenoiseFarm, WithoutABackwardsHalfAFrameIsNotWritten) {
  open_farm(2);
  write_shot({1, 2, 3});
  DenoiseOptions o = through_farm(shot("there"));
  o.both_ways = true;
  EXPECT_EQ(run(o), static_cast<int>(ExitCode::job_failed));
  EXPECT_THAT(problems_, HasSubstr("frame 1 starts anew, backwards: frame 2 failed"));
  EXPECT_THAT(problems_, HasSubstr("frame 3 starts anew: frame 2 failed"));
  EXPECT_TRUE(there("there", 1));
  EXPECT_FALSE(there("there", 2));
  EXPECT_TRUE(there("there", 3));
}

TEST_F(DenoiseFarm, ItsJobIsAJobLikeOthers) {
  open_farm();
  write_shot({1});
  ASSERT_EQ(run(through_farm(still())), 0) << problems_;
  FarmLink link({.coordinator = "ipc://" + path("farm"), .keys = {}});
  const JobDetail detail = link.ask<JobDetail>(ShowJob{job()});
  EXPECT_EQ(detail.summary.state, JobState::completed);
  EXPECT_THAT(detail.summary.name, HasSubstr("denoise in.0001.exr"));
  EXPECT_EQ(fetch_job(link, {.job = job(), .output = path("fetched.exr"), .quiet = true}), ExitCode::done);
  const ExrImage fetched = read_exr(path("fetched.exr")), written = read_exr(path("out.exr"));
  for (const char* channel : {"R", "G", "B"})
    EXPECT_TRUE(std::ranges::equal(fetched.pixels.plane(fetched.plane(channel)),
                                   written.pixels.plane(written.plane(channel))));
  EXPECT_EQ(fetched.channels.size(), 3u);
  EXPECT_TRUE(fs::exists(path("fetched.png")));
}

TEST(JobNames, AreMadeOfWhateverAFileIsCalled) {
  for (const char* word : {"shot.####", "my scene (1)", ".hidden", "", "caf\xc3\xa9"})
    EXPECT_TRUE(is_job_name(own_id(word))) << word;
  EXPECT_THAT(own_id("shot-1.v2"), testing::StartsWith("shot-1.v2-"));
}

TEST_F(DenoiseFarm, WhatTheFarmHasIsNotUploadedAgain) {
  open_farm();
  write_shot({1});
  const DenoiseOptions o = through_farm(still());
  ASSERT_EQ(run(o), 0) << problems_;
  const auto blobs = [&] {
    std::map<std::string, std::uintmax_t> sizes;
    for (const auto& f : fs::recursive_directory_iterator(path("store/blobs")))
      if (f.is_regular_file()) sizes[f.path().filename().string()] = f.file_size();
    return sizes;
  };
  const auto before = blobs();
  ASSERT_EQ(run(o), 0) << problems_;
  const std::uintmax_t planes =
      std::ranges::max_element(before, {}, [](const auto& b) { return b.second; })->second;
  std::uintmax_t largest = 0;  // of what has come since: an image, a submission
  for (const auto& [digest, size] : blobs())
    if (!before.contains(digest)) largest = std::max(largest, size);
  EXPECT_GT(largest, 0u);
  EXPECT_LT(largest, planes);
}

TEST_F(DenoiseFarm, RefusesADeviceAndSaysThatNobodyAnswers) {
  write_shot({1});
  DenoiseOptions device = through_farm(still());
  device.device = "my own";
  const Error refused = error_of(device);
  EXPECT_EQ(refused.code(), ExitCode::bad_usage);
  EXPECT_THAT(refused.what(), HasSubstr("workers have devices of their own"));
  DenoiseOptions nobody = through_farm(still());
  nobody.farm.timeout = 0.3;
  EXPECT_EQ(error_of(nobody).code(), ExitCode::unreachable);
  EXPECT_FALSE(fs::exists(path("out.exr")));
}

}  // namespace
}  // namespace tessera
