// SPDX-License-Identifier: Apache-2.0
// The farm as a service: jobs handed in, kept, gone on with by another life of the coordinator.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "coordinator/farm/desk.h"
#include "coordinator/farm/farm.h"
#include "core/bundle.h"
#include "core/exr.h"
#include "proto/submission_codec.h"
#include "small_scene.h"
#include "test_farm.h"

namespace tessera::farm {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::shared_ptr<const Scene> scene() {
  static const auto made = small_scene();
  return made;
}

TaskRunner& runner() {
  static const auto made = make_task_runner(scene_in_hand(scene()), DevicePool::open({}));
  return *made;
}

// Fails every task of the jobs with that many bounces.
class Poisoned : public TaskRunner {
 public:
  explicit Poisoned(int bounces) : bounces_(bounces) {}
  TaskResult run(const Job& job, const Task& task, const FilterInput& input,
                 const std::atomic<bool>& cancel) override {
    if (job.render.max_bounces == bounces_) throw Error(ExitCode::internal_error, "this one is poison");
    return runner().run(job, task, input, cancel);
  }

 private:
  int bounces_;
};

// Does one task, and no other until it is let.
class Held : public TaskRunner {
 public:
  TaskResult run(const Job& job, const Task& task, const FilterInput& input,
                 const std::atomic<bool>& cancel) override {
    if (begun_++ > 0) let_.wait(false);
    return runner().run(job, task, input, cancel);
  }
  void let() {
    let_ = true;
    let_.notify_all();
  }

 private:
  std::atomic<int> begun_ = 0;
  std::atomic<bool> let_ = false;
};

class Service : public WithDevice {
 protected:
  void SetUp() override {
    WithDevice::SetUp();
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("service-") + info->name());
    fs::remove_all(folder_);
  }
  void TearDown() override {
    farm_.reset();
    hands_.clear();
    fs::remove_all(folder_);
  }

  FarmOptions options() const {
    CoordinatorOptions coordinator = impatient();
    coordinator.scheduler.max_attempts = 3;
    return {.coordinator = coordinator, .store = folder_ / "store", .memory = 1e9, .version = "0"};
  }

  Farm& farm() {
    if (farm_) return *farm_;
    road_ = listen();
    address_ = road_->endpoints().front();
    return *(farm_ = std::make_unique<Farm>(*road_, options()));
  }
  // Where the life before did, whose socket may take a moment to close.
  std::unique_ptr<ZmqRouter> listen() {
    const Instant end = clock_now() + std::chrono::seconds(20);
    for (;;) try {
        return std::make_unique<ZmqRouter>(context_, std::vector{address_});
      } catch (const Error&) {
        if (clock_now() > end) throw;
        std::this_thread::yield();
      }
  }
  void die() {
    farm_.reset();
    road_.reset();
  }
  void hire(int workers, TaskRunner& does) {
    for (int i = 0; i < workers; ++i) {
      const std::string id = "worker-" + std::to_string(hands_.size());
      hands_.push_back(std::make_unique<Hand>(std::make_unique<ZmqDealer>(context_, address_, id), does));
    }
  }

  Submission submission(int bounces = 3, std::vector<int> frames = {0}) const {
    Submission s{.name = "test", .job = small_job(*scene()), .frames = std::move(frames)};
    s.job.render.max_bounces = bounces;
    return s;
  }
  Reply ask(const Question& question, const Identity& who = {}) { return answer(farm(), question, who); }
  Reply submit(const JobName& name, Submission s, const Identity& who = {}) {
    BlobStore& blobs = farm().store().blobs();
    const Digest file = blobs.put("{}");
    s.job.scene.bundle = blobs.put(to_text({"scene.json", {{"scene.json", file, 2}}}));
    s.job.scene.path = "scene.json";
    return ask(Submit{name, blobs.put(encode(s))}, who);
  }
  JobSummary job(const JobName& name) { return std::get<JobDetail>(ask(ShowJob{name})).summary; }

  // Turns the farm until it is so. False if it takes too long.
  template <class Condition>
  bool comes(const Condition& condition) {
    const Instant end = clock_now() + std::chrono::seconds(100);
    while (!condition()) {
      if (clock_now() > end) return false;
      farm().turn(clock_now() + Millis(20));
    }
    return true;
  }
  bool comes_to(const JobName& name, JobState state) {
    return comes([&] { return job(name).state == state; });
  }
  std::vector<float> image_of(const JobName& name, std::uint32_t place = 0) {
    const auto frames = std::get<JobDetail>(ask(ShowJob{name})).frames;
    const ExrImage exr = read_exr(farm().store().blobs().path(frames.at(place).image));
    std::vector<float> pixels;
    for (const char* channel : {"R", "G", "B"}) {
      const auto plane = exr.pixels.plane(exr.plane(channel));
      pixels.insert(pixels.end(), plane.begin(), plane.end());
    }
    return pixels;
  }
  std::string events(const JobName& name) {
    std::string all;
    const EventList list = std::get<EventList>(ask(ListEvents{name}));
    for (const JobEvent& e : list.events) all += e.text + "\n";
    return all;
  }

  fs::path folder_;
  std::string address_ = "tcp://127.0.0.1:*";
  ZmqContext context_;
  std::unique_ptr<ZmqRouter> road_;
  std::unique_ptr<Farm> farm_;
  std::vector<std::unique_ptr<Hand>> hands_;
};

TEST_F(Service, MakesTheImageOfALocalRun) {
  const JobReport local =
      over_zmq(runner(), 1, "inproc://alone", [](Coordinator& c) { return c.run(small_job(*scene())); });
  farm();
  hire(2, runner());
  EXPECT_TRUE(std::holds_alternative<Agreed>(submit("one", submission())));
  ASSERT_TRUE(comes_to("one", JobState::completed)) << events("one");
  const std::vector<float> image = image_of("one");
  ASSERT_EQ(image.size(), 3 * local.image.filtered.plane(0).size());
  for (std::size_t i = 0; i < image.size(); ++i)
    ASSERT_NEAR(image[i], local.image.filtered.data()[i],
                1e-3f * (1 + std::abs(image[i])));  // halves in the file
}

TEST_F(Service, GoesOnInAnotherLifeWithTheSameBits) {
  farm();
  hire(2, runner());
  submit("undisturbed", submission(3, {4, 5}));
  ASSERT_TRUE(comes_to("undisturbed", JobState::completed));
  submit("disturbed", submission(3, {4, 5}));
  double reached = 0;
  int lives = 1;
  while (job("disturbed").state != JobState::completed && lives < 12) {
    ASSERT_TRUE(comes([&] {
      return job("disturbed").fraction > reached + 0.1 || job("disturbed").state == JobState::completed;
    }));
    reached = job("disturbed").fraction;
    die();
    ++lives;
  }
  ASSERT_TRUE(comes_to("disturbed", JobState::completed)) << events("disturbed");
  EXPECT_GT(lives, 3);
  for (const std::uint32_t place : {0u, 1u})
    EXPECT_EQ(image_of("disturbed", place), image_of("undisturbed", place));
}

TEST_F(Service, DoesUrgentJobsFirst) {
  submit("slow", submission());
  submit("urgent", [&] {
    Submission s = submission();
    s.priority = 90;
    return s;
  }());
  hire(1, runner());
  ASSERT_TRUE(comes_to("urgent", JobState::completed));
  EXPECT_NE(job("slow").state, JobState::completed);
  EXPECT_TRUE(comes_to("slow", JobState::completed));
}

TEST_F(Service, PausesGoesOnAndCancels) {
  submit("paused", submission());
  submit("other", submission());
  ask(Control{"paused", Verb::pause});
  hire(1, runner());
  ASSERT_TRUE(comes_to("other", JobState::completed));
  EXPECT_EQ(job("paused").state, JobState::paused);
  ask(Control{"paused", Verb::resume});
  submit("unwanted", submission());
  ask(Control{"unwanted", Verb::cancel});
  ASSERT_TRUE(comes_to("paused", JobState::completed));
  EXPECT_EQ(job("unwanted").state, JobState::cancelled);
  EXPECT_EQ(job("unwanted").reason, "cancelled by local");
}

TEST_F(Service, KeepsToTheOrderAmongJobs) {
  Submission second = submission();
  second.after = {"first"};
  EXPECT_THAT(std::get<Denied>(submit("second", second)).reason, HasSubstr("there is no job first"));
  submit("first", submission());
  submit("second", second);
  EXPECT_EQ(job("second").reason, "waits for first");
  hire(1, runner());
  ASSERT_TRUE(comes_to("first", JobState::completed));
  ASSERT_TRUE(comes_to("second", JobState::completed));
}

TEST_F(Service, FailsAPoisonousJobAndNoOther) {
  Poisoned poisoned(7);
  farm();
  hire(2, poisoned);
  submit("good", submission());
  submit("poison", submission(7));
  ASSERT_TRUE(comes_to("poison", JobState::failed));
  EXPECT_THAT(job("poison").reason, HasSubstr("this one is poison"));
  EXPECT_THAT(events("poison"), HasSubstr("failed a task"));
  EXPECT_TRUE(comes_to("good", JobState::completed));
  hands_.clear();
}

TEST_F(Service, IsTheSameJobIfItIsSubmittedAgain) {
  submit("one", submission());
  EXPECT_TRUE(std::holds_alternative<Agreed>(submit("one", submission())));
  EXPECT_EQ(std::get<JobList>(ask(ListJobs{})).jobs.size(), 1u);
  EXPECT_THAT(std::get<Denied>(submit("one", submission(2))).reason, HasSubstr("one"));
}

TEST_F(Service, RefusesWhatItHasNoMemoryFor) {
  Submission big = submission();
  big.job.render.size = {8000, 8000};
  const Denied denied = std::get<Denied>(submit("big", big));
  EXPECT_EQ(denied.code, ExitCode::out_of_memory);
  EXPECT_THAT(denied.reason, HasSubstr("more than the limit"));
}

TEST_F(Service, EndsAJobAtItsLimitWithTheImagesItHas) {
  Submission limited = submission(3, {0, 1, 2, 3, 4, 5});
  limited.limits.pixel_samples = 77 * 70 * 40;
  submit("limited", limited);
  hire(1, runner());
  ASSERT_TRUE(comes_to("limited", JobState::failed));
  EXPECT_THAT(job("limited").reason, HasSubstr("pixel samples is reached"));
  EXPECT_EQ(image_of("limited").size(), 3u * 77 * 70);
}

TEST_F(Service, LetsEachDoOnlyWhatItsKeyAllows) {
  const Identity ann{"ann", false, true, false}, bob{"bob", false, true, false},
      root{"root", false, false, true}, worker{"rack", true, false, false};
  submit("anns", submission(), ann);
  EXPECT_EQ(job("anns").owner, "ann");
  EXPECT_THAT(std::get<Denied>(ask(Control{"anns", Verb::cancel}, bob)).reason, HasSubstr("which is ann's"));
  EXPECT_THAT(std::get<Denied>(submit("workers", submission(), worker)).reason,
              HasSubstr("keys of submitters"));
  EXPECT_THAT(std::get<Denied>(ask(Control{"anns", Verb::set_priority, 60}, ann)).reason,
              HasSubstr("above 50"));
  EXPECT_TRUE(std::holds_alternative<Agreed>(ask(Control{"anns", Verb::set_priority, 60}, root)));
  EXPECT_THAT(std::get<Denied>(ask(ReleaseWorker{"rack"}, ann)).reason, HasSubstr("keys of administrators"));
  EXPECT_TRUE(std::holds_alternative<Agreed>(ask(Control{"anns", Verb::cancel}, root)));
}

TEST_F(Service, ShowsAFrameUnderWayWhileSomebodyLooks) {
  Held held;
  submit("one", submission());
  hire(1, held);
  Digest preview;
  const bool shown = comes([&] {
    preview = std::get<JobDetail>(ask(ShowJob{"one", 0, true})).frames.at(0).preview;
    return !preview.empty();
  });
  const Reply there = ask(GetPiece{preview});
  held.let();
  ASSERT_TRUE(shown);
  EXPECT_THAT(std::get<Piece>(there).bytes, testing::StartsWith("\x89PNG"));
  EXPECT_EQ(std::get<Piece>(there).size, std::get<Piece>(there).bytes.size());
  ASSERT_TRUE(comes_to("one", JobState::completed)) << events("one");
  EXPECT_NE(std::get<JobDetail>(ask(ShowJob{"one", 0, true})).frames.at(0).preview, preview);
  EXPECT_TRUE(std::holds_alternative<Denied>(ask(GetPiece{preview}))) << "it is not kept";
}

TEST_F(Service, HasTasksDoneAgainElsewhereAndComparesBits) {
  farm();
  hire(2, runner());
  submit("one", submission());
  ASSERT_TRUE(comes_to("one", JobState::completed));
  EXPECT_TRUE(std::holds_alternative<Agreed>(ask(Control{"one", Verb::verify, 3})));
  ASSERT_TRUE(comes([&] {
    const std::string all = events("one");
    std::size_t found = 0, count = 0;
    while ((found = all.find("the same bits", found)) != all.npos) ++found, ++count;
    return count == 3;
  })) << events("one");
  EXPECT_EQ(farm().wrong_bits(), 0u);
}

}  // namespace
}  // namespace tessera::farm
