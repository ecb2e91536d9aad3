// SPDX-License-Identifier: Apache-2.0
// The farm as a service: jobs handed in, kept, gone on with by another life of the coordinator.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/farm/service.h"

namespace tessera::farm {
namespace {

using testing::HasSubstr;

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
  int lives = 0;
  ASSERT_NO_FATAL_FAILURE(disturb("disturbed", lives));
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

TEST_F(Service, RemovesJobsThatAreOver) {
  Submission second = submission();
  second.after = {"first"};
  submit("first", submission());
  submit("second", second);
  EXPECT_THAT(std::get<Denied>(ask(Control{"second", Verb::remove})).reason, HasSubstr("is not over"));
  ask(Control{"second", Verb::pause});
  hire(1, runner());
  ASSERT_TRUE(comes_to("first", JobState::completed));
  EXPECT_THAT(std::get<Denied>(ask(Control{"first", Verb::remove})).reason, HasSubstr("comes after"));
  ask(Control{"second", Verb::cancel});
  const Digest image = std::get<JobDetail>(ask(ShowJob{"first"})).frames.at(0).image;
  ASSERT_TRUE(farm().store().blobs().has(image));
  for (int times = 0; times < 2; ++times)
    EXPECT_TRUE(std::holds_alternative<Agreed>(ask(Control{"first", Verb::remove})));
  EXPECT_TRUE(std::holds_alternative<Denied>(ask(ShowJob{"first"})));
  farm().store().collect(unix_ms() + 1000);
  EXPECT_FALSE(farm().store().blobs().has(image));
  submit("first", submission(2));  // the name is free
  EXPECT_TRUE(comes_to("first", JobState::completed));
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

TEST_F(Service, HoldsAnAnswerUntilThereIsSomethingNew) {
  submit("one", submission());
  farm().turn(clock_now());
  const std::uint64_t seen = std::get<JobDetail>(ask(ShowJob{"one"})).stamp;
  const Question question = ShowJob{"one", 0, false, seen};
  EXPECT_TRUE(may_wait(farm(), question));
  EXPECT_FALSE(may_wait(farm(), ShowJob{"one"}));  // asks for the first time
  EXPECT_FALSE(may_wait(farm(), ShowJob{"none", 0, false, seen}));

  ZmqDealer dealer(context_, address_, "ada");
  dealer.await(clock_now() + std::chrono::seconds(10));
  dealer.send("coordinator", Ask{1, question});
  ask(Control{"one", Verb::pause});
  EXPECT_FALSE(may_wait(farm(), question));
  std::optional<Mail> mail;
  ASSERT_TRUE(comes([&] { return (mail = dealer.receive(clock_now())).has_value(); }));
  const auto detail = std::get<JobDetail>(std::get<Answer>(mail->message).reply);
  EXPECT_EQ(detail.summary.state, JobState::paused);
  EXPECT_NE(detail.stamp, seen);

  dealer.send("coordinator", Ask{2, ShowJob{"one", 0, false, detail.stamp}});  // nothing happens any more
  ASSERT_TRUE(comes([&] { return (mail = dealer.receive(clock_now())).has_value(); }));
  EXPECT_EQ(std::get<Answer>(mail->message).number, 2u);
  ask(Control{"one", Verb::cancel});
  EXPECT_EQ(std::get<JobDetail>(ask(ShowJob{"one"})).stamp, 0u);
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
