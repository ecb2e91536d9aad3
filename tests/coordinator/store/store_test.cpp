// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/coordinator/store/folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::int64_t kEver = std::numeric_limits<std::int64_t>::max();

JobRecord sample_job(const std::string& name) {
  return {.job = name,
          .submission = sha256(name),
          .name = "caf\xc3\xa9 \xff",
          .owner = "somebody",
          .submitted = 1'700'000'000'123,
          .state = JobState::active,
          .reason = "because",
          .priority = 70,
          .seconds = 1.5,
          .pixel_samples = std::uint64_t{1} << 40,
          .failed_tasks = 3};
}

FrameRecord sample_frame(std::uint32_t place) {
  return {.place = place,
          .frame = static_cast<int>(place) * 2 - 7,
          .state = FrameState::completed,
          .reason = "done",
          .image_key = "key",
          .image = sha256("image"),
          .preview = sha256("preview"),
          .kept = sha256("kept"),
          .rounds = 5,
          .seconds = 2.25,
          .pixel_samples = 12345,
          .error = 0.001,
          .acceptable_share = 0.5,
          .errors = {0.5f, 0.25f}};
}

Accepted accepted(int begin) {
  return {RenderTask{{0, 0, 16, 8}, {begin, begin + 8}}, 1, sha256("pixels"), "worker", "class", 0.5, 0};
}

TEST(Store, KeepsJobsAndFramesAsTheyWereSaved) {
  Folder folder;
  JobRecord job = sample_job("one");
  {
    Store store(folder.path());
    const std::vector frames{sample_frame(0), sample_frame(1), sample_frame(2)};
    const Store::Added added = store.add(job, frames, {});
    EXPECT_TRUE(added.fresh);
    EXPECT_EQ(added.job.number, 1u);
    job.number = 1;
    EXPECT_EQ(store.job("one"), job);
    job.state = JobState::paused;
    job.reason = "asked to";
    job.priority = 3;
    job.seconds = 9;
    job.pixel_samples = 10;
    job.failed_tasks = 11;
    store.save(job);
    FrameRecord changed = sample_frame(1);
    changed.state = FrameState::failed;
    changed.error.reset();
    changed.errors.clear();
    store.save(1, changed);
  }
  Store store(folder.path());
  EXPECT_EQ(store.job("one"), job);
  EXPECT_EQ(store.job("two"), std::nullopt);
  const auto frames = store.frames(1, 0, 100);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0], sample_frame(0));
  EXPECT_EQ(frames[1].state, FrameState::failed);
  EXPECT_EQ(frames[1].error, std::nullopt);
  EXPECT_EQ(frames[2], sample_frame(2));
  EXPECT_EQ(store.frames(1, 1, 1).size(), 1u);
  EXPECT_EQ(store.frames(1, 1, 1)[0].place, 1u);
}

TEST(Store, TheSameJobTwiceIsOneAndAnotherOfItsNameIsRefused) {
  Folder folder;
  Store store(folder.path());
  const std::vector frames{sample_frame(0)};
  store.add(sample_job("one"), frames, {});
  JobRecord again = sample_job("one");
  again.submitted = 5;
  const Store::Added added = store.add(again, {}, {});
  EXPECT_FALSE(added.fresh);
  EXPECT_EQ(added.job.submitted, sample_job("one").submitted);
  EXPECT_EQ(store.frames(1, 0, 9).size(), 1u);
  again.submission = sha256("another");
  EXPECT_THAT([&] { store.add(again, {}, {}); }, ThrowsMessage<Error>(HasSubstr("one")));
  again = sample_job("one");
  again.owner = "somebody else";
  EXPECT_THROW(store.add(again, {}, {}), Error);
}

TEST(Store, ListsJobsByNumberAndThoseThatAreNotOver) {
  Folder folder;
  Store store(folder.path());
  const std::vector states{JobState::queued,    JobState::active, JobState::paused,
                           JobState::completed, JobState::failed, JobState::cancelled};
  for (const JobState state : states) {
    JobRecord job = sample_job("job-" + std::to_string(static_cast<int>(state)));
    job.state = state;
    store.add(job, {}, {});
  }
  const auto numbers = [](const std::vector<JobRecord>& jobs) {
    std::vector<std::uint64_t> all;
    for (const JobRecord& job : jobs) all.push_back(job.number);
    return all;
  };
  EXPECT_THAT(numbers(store.jobs(0, 4)), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(numbers(store.jobs(4, 4)), ElementsAre(5, 6));
  EXPECT_THAT(numbers(store.unfinished_jobs()), ElementsAre(1, 2, 3));
}

TEST(Store, NumbersEventsOfEachJob) {
  Folder folder;
  Store store(folder.path());
  store.add(sample_job("one"), {}, {});
  store.add(sample_job("two"), {}, {});
  EXPECT_EQ(store.add_event(1, 100, "begun"), 1u);
  EXPECT_EQ(store.add_event(2, 101, "begun, too"), 1u);
  EXPECT_EQ(store.add_event(1, 102, "done"), 2u);
  const auto events = store.events(1, 1, 10);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].number, 2u);
  EXPECT_EQ(events[0].when, 102);
  EXPECT_EQ(events[0].text, "done");
}

TEST(Store, ATransactionThatIsNotCommittedChangesNothing) {
  Folder folder;
  Store store(folder.path());
  {
    Store::Transaction changes(store);
    store.add(sample_job("one"), {}, {});
    store.add_event(1, 1, "begun");
  }
  EXPECT_EQ(store.job("one"), std::nullopt);
  {
    Store::Transaction changes(store);
    store.add(sample_job("one"), {}, {});
    EXPECT_THROW(store.save(99, sample_frame(0)), StoreError) << "a frame of no job";
    store.add_event(1, 1, "begun");
    changes.commit();
  }
  EXPECT_EQ(store.events(1, 0, 9).size(), 1u);
}

TEST(Store, AJobWhoseFramesCannotBeAddedIsNotAdded) {
  Folder folder;
  Store store(folder.path());
  std::vector frames{sample_frame(0)};
  frames[0].acceptable_share = std::numeric_limits<double>::quiet_NaN();  // SQLite takes it for NULL
  EXPECT_THROW(store.add(sample_job("one"), frames, {}), StoreError);
  EXPECT_EQ(store.job("one"), std::nullopt);
}

TEST(Store, RemovesAJobWithAllThatIsKeptOfItAndNeverGivesItsNumberAgain) {
  Folder folder;
  Store store(folder.path());
  const Digest shared = store.blobs().put("shared"), own = store.blobs().put("own");
  const std::vector frames{sample_frame(0)};
  JobRecord one = sample_job("one"), two = sample_job("two");
  one.submission = store.blobs().put("submission of one");
  two.submission = store.blobs().put("submission of two");
  store.add(one, frames, std::vector{shared, own});
  store.add(two, {}, std::vector{shared});
  store.add_event(1, 5, "begun");
  EXPECT_EQ(store.collect(kEver), 0u);
  store.remove(1);
  EXPECT_EQ(store.job("one"), std::nullopt);
  EXPECT_TRUE(store.frames(1, 0, 9).empty());
  EXPECT_TRUE(store.events(1, 0, 9).empty());
  EXPECT_EQ(store.collect(kEver), std::string("own").size() + std::string("submission of one").size());
  EXPECT_TRUE(store.blobs().has(shared));
  store.remove(2);
  EXPECT_EQ(store.add(sample_job("three"), {}, {}).job.number, 3u);
}

TEST(Store, KeepsTheResultsOfFramesAsBlobs) {
  Folder folder;
  Store store(folder.path());
  store.add(sample_job("one"), {}, {});
  FrameRecord frame = sample_frame(0);
  frame.image = store.blobs().put("EXR");
  frame.preview = store.blobs().put("PNG");
  frame.kept = store.blobs().put("history");
  store.save(1, frame);
  store.blobs().put("nobody's");
  EXPECT_EQ(store.collect(kEver), 8u);
  EXPECT_TRUE(store.blobs().has(frame.kept));
}

TEST(Store, AFrameThatEndsLeavesItsAcceptedTasksAndNoJournal) {
  Folder folder;
  Store store(folder.path());
  FrameRecord frame = sample_frame(4);
  frame.state = FrameState::active;
  store.add(sample_job("one"), std::vector{frame}, {});
  Journal journal = store.journal(1, 4, "frame");
  const Image pixels({0, 0, 16, 8}, 1);
  std::vector<Accepted> tasks;
  for (int i = 0; i < 6; ++i) {
    tasks.push_back(accepted(8 * i));
    journal.append(tasks.back(), pixels);
    if (i == 2) {
      Checkpoint checkpoint;
      store.checkpoint(1, 4, journal, checkpoint);
      EXPECT_EQ(store.accepted_count(1), 3u);
    }
  }
  frame.state = FrameState::completed;
  store.finish(1, frame, std::move(journal));
  EXPECT_EQ(store.frames(1, 0, 9)[0], frame);
  EXPECT_TRUE(fs::is_empty(folder.path() / "frames"));
  ASSERT_EQ(store.accepted_count(1), 6u);
  std::vector<Accepted> found;
  for (std::uint64_t i = 0; i < 6; ++i) {
    found.push_back(store.accepted_at(1, i)->accepted);
    EXPECT_EQ(store.accepted_at(1, i)->place, 4u);
  }
  EXPECT_THAT(found, testing::UnorderedElementsAreArray(tasks));
  EXPECT_EQ(store.accepted_at(1, 6), std::nullopt);
}

TEST(Store, DropsJournalsOfFramesThatAreNotActive) {
  Folder folder;
  Store store(folder.path());
  FrameRecord active = sample_frame(0), done = sample_frame(1);
  active.state = FrameState::active;
  store.add(sample_job("one"), std::vector{active, done}, {});
  for (const auto& [job, place] : {std::pair{1, 0}, std::pair{1, 1}, std::pair{1, 2}, std::pair{7, 0}})
    store.journal(job, place, "frame");
  fs::create_directory(folder.path() / "frames" / "1-0-old");
  store.drop_stale_journals();
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(folder.path() / "frames"))
    left.push_back(entry.path().filename());
  EXPECT_THAT(left, ElementsAre("1-0"));
}

}  // namespace
}  // namespace tessera
