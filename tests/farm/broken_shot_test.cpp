// SPDX-License-Identifier: Apache-2.0
// What is recorded of the frames of a shot of which one has failed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/resume.h"
#include "tests/farm/service.h"

namespace tessera::farm {
namespace {

// Fails frame 5.
class FailsOne : public TaskRunner {
 public:
  TaskResult run(const Job& job, const Task& task, const FilterInput& input,
                 const std::atomic<bool>& cancel) override {
    if (job.frame == 5) throw InputError("scene.json:/cameras/0", "is inside a wall", "a camera outside");
    return runner().run(job, task, input, cancel);
  }
};

std::string key_in(const fs::path& exr) {
  const ExrImage image = read_exr(exr);
  const std::string* key = image.about<std::string>("tessera/job");
  return key != nullptr ? *key : "none";
}

// Also where another life of the coordinator goes on behind the break.
TEST_F(Service, RecordsFramesBehindOneThatFailedAsWhatTheyAre) {
  for (const bool two_lives : {false, true}) {
    const JobName name = two_lives ? "disturbed" : "shot";
    static FailsOne fails;  // until all hands are gone
    Submission shot = submission(3, {4, 5, 6, 7, 8, 9});
    shot.job.filter = parse_filter("svgf:levels=2,history=on");
    submit(name, shot);
    hire(1, fails);
    const auto frames = [&] { return std::get<JobDetail>(ask(ShowJob{name})).frames; };
    ASSERT_TRUE(comes([&] { return frames().at(2).state == FrameState::completed; })) << events(name);
    if (two_lives) die();
    ASSERT_TRUE(comes_to(name, JobState::failed)) << events(name);
    const std::vector<Job> jobs = jobs_of(shot);
    std::string expected = image_key(jobs[2], "");
    for (std::uint32_t place = 2; place < 6; ++place) {
      if (place > 2) expected = image_key(jobs[place], expected);
      EXPECT_EQ(key_in(farm().store().blobs().path(frames().at(place).image)), expected) << place;
      EXPECT_EQ(farm().store().frames(farm().record(name).number, place, 1).at(0).image_key, expected);
    }
    hands_.clear();
  }
}

}  // namespace
}  // namespace tessera::farm
