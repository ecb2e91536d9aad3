// SPDX-License-Identifier: Apache-2.0
#include "coordinator/recovery.h"

#include <gtest/gtest.h>

#include <deque>
#include <filesystem>
#include <optional>
#include <random>

#include "core/filter/filter.h"
#include "tests/coordinator/made_up_frame.h"
#include "tests/coordinator/store/folder.h"

namespace tessera {
namespace {

constexpr float kNoise = 0.6f;

// A coordinator that is killed after every `every` entries (0: never), and starts again with nothing but the
// journal.
class Forgetful {
 public:
  Forgetful(const Job& job, std::optional<Image> history, int every, bool checkpoints,
            Planes planes = nullptr)
      : job_(job),
        planes_(std::move(planes)),
        history_(std::move(history)),
        every_(every),
        checkpoints_(checkpoints) {}

  FrameImage work_off(unsigned seed) {
    std::mt19937 random(seed);
    rise();
    for (;;) {
      if (awaits_ && random() % 4 == 0) remember();
      if (frame_->round_complete() && !look()) break;
      if (todo_.empty()) remember();
      std::swap(todo_.front(), todo_[random() % todo_.size()]);
      const Work work = todo_.front();
      todo_.pop_front();
      do_work(work);
      if (every_ > 0 && ++since_ >= every_) {
        since_ = 0;
        ++kills_;
        rise();
      }
    }
    EXPECT_TRUE(frame_->stopped());
    if (job_.filter.history() > 0) kept_ = *frame_->kept();
    return frame_->image();
  }

  int kills() const { return kills_; }
  int checkpoints() const { return taken_; }
  const Image& kept() const { return kept_; }

 private:
  void rise() {
    journal_.emplace(folder_.path() / "journal", "a frame");
    const auto load = [&](const Digest& digest) {
      EXPECT_EQ(digest, sha256("history"));
      return std::make_shared<const Image>(*history_);
    };
    RecoveredFrame recovered = recover(job_, *journal_, load, planes_);
    frame_ = std::move(recovered.frame);
    awaits_ = recovered.awaits_history;
    EXPECT_EQ(recovered.dropped, dropped_);
    EXPECT_EQ(recovered.seconds, seconds_);
    EXPECT_EQ(recovered.errors, errors_);
    todo_.clear();
    add(frame_->outstanding());
  }

  void add(const std::vector<Work>& work) { todo_.insert(todo_.end(), work.begin(), work.end()); }

  void remember() {
    ASSERT_TRUE(awaits_) << "a round without work that is not complete";
    awaits_ = false;
    journal_->append(Remembered{history_ ? sha256("history") : ""});
    add(frame_->remember(history_ ? std::make_shared<const Image>(*history_) : nullptr));
  }

  void do_work(const Work& work) {
    Accepted accepted{work, 1, {}, "worker", "class", 0.5, 1};
    ++dropped_;
    if (const auto* render = std::get_if<RenderTask>(&work)) {
      Block block = rendered(*render, layout_, kNoise);
      journal_->append(accepted, block.sums);
      add(frame_->fold(std::move(block)));
    } else {
      const FilterTask& task = std::get<FilterTask>(work);
      const Filtered planes = filtered(task, frame_->filter_input(task), job_);
      journal_->append(accepted, planes);
      frame_->stitch(task, planes);
    }
  }

  bool look() {
    EXPECT_TRUE(todo_.empty()) << "a round that is complete leaves no work";
    seconds_ += 1;
    journal_->append(Looked{seconds_});
    add(frame_->look({seconds_}));
    if (frame_->stopped()) return false;
    errors_.push_back(static_cast<float>(*frame_->progress(0).error));
    if (checkpoints_ && frame_->image().rounds % 2 == 0) {
      journal_->restart({frame_->snapshot(), seconds_, dropped_, {"class"}, errors_});
      ++taken_;
    }
    return true;
  }

  Job job_;
  Planes planes_;
  FilmLayout layout_{film_aovs(job_)};
  std::optional<Image> history_;
  int every_;
  bool checkpoints_;
  Folder folder_;
  std::optional<Journal> journal_;
  std::unique_ptr<Frame> frame_;
  std::deque<Work> todo_;
  bool awaits_ = true;
  double seconds_ = 0;
  std::uint64_t dropped_ = 0;
  std::vector<float> errors_;
  int since_ = 0, kills_ = 0, taken_ = 0;
  Image kept_;
};

Job small_job() {
  Job job;
  job.render.size = {150, 90};
  job.acceptance.relmse = 0.002;
  job.acceptance.max_samples = 256;
  job.task_samples = 1 << 14;
  return job;
}

void expect_same(const FrameImage& a, const FrameImage& b) {
  EXPECT_TRUE(same_bits(a.filtered, b.filtered));
  EXPECT_TRUE(same_bits(a.sums, b.sums));
  EXPECT_EQ(a.states, b.states);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.acceptable_share, b.acceptable_share);
  EXPECT_EQ(a.stop, b.stop);
  EXPECT_EQ(a.rounds, b.rounds);
  EXPECT_EQ(a.pixel_samples, b.pixel_samples);
}

struct Case {
  const char* name;
  Job job;
};

std::vector<Case> cases() {
  Job odd = small_job(), cropped = small_job(), one_round = small_job(), fine = small_job();
  odd.tile = {37, 53};
  odd.filter = parse_filter("atrous");
  cropped.crop = Region{13, 7, 141, 83};
  cropped.tile = {64, 64};
  one_round.acceptance.relmse.reset();
  one_round.acceptance.max_samples = 64;
  fine.task_samples = 1 << 9;  // many blocks that wait for a sibling
  fine.render.size = {70, 66};
  return {{"odd tiles", odd}, {"crop", cropped}, {"one round", one_round}, {"fine tasks", fine}};
}

TEST(Recovery, AFrameKilledAfterEveryKthResultEndsWithTheSameBits) {
  for (const Case& c : cases()) {
    const FrameImage undisturbed = Forgetful(c.job, {}, 0, false).work_off(1);
    for (const int every : {1, 3, 20})
      for (const bool checkpoints : {false, true}) {
        SCOPED_TRACE(testing::Message() << c.name << ", every " << every << ", checkpoints " << checkpoints);
        Forgetful forgetful(c.job, {}, every, checkpoints);
        expect_same(forgetful.work_off(100 + every), undisturbed);
        EXPECT_GT(forgetful.kills(), 0);
        EXPECT_EQ(forgetful.checkpoints() > 0, checkpoints && undisturbed.rounds > 2);
      }
  }
}

TEST(Recovery, AFrameThatGoesByTheOneBeforeIsGoneOnWithWhetherItHadItsHistoryOrNot) {
  Job job = small_job();
  job.filter = parse_filter("svgf:history=on");
  Forgetful first(job, {}, 3, true);
  first.work_off(1);
  ASSERT_FALSE(first.kept().empty());
  const FrameImage alone = Forgetful(job, {}, 0, false).work_off(2);
  const FrameImage undisturbed = Forgetful(job, first.kept(), 0, false).work_off(3);
  EXPECT_FALSE(same_bits(alone.filtered, undisturbed.filtered)) << "the history changes nothing";
  for (const int every : {1, 4, 9})
    for (const bool checkpoints : {false, true})
      expect_same(Forgetful(job, first.kept(), every, checkpoints).work_off(10 + every), undisturbed);
}

TEST(Recovery, AFrameThatIsGivenIsGoneOnWithWhetherItHadItsHistoryOrNot) {
  const Job job = given_job("svgf:history=on");
  const Planes planes = given_planes_of(job);
  Forgetful first(job, {}, 2, false, planes);
  const FrameImage alone = Forgetful(job, {}, 0, false, planes).work_off(1);
  expect_same(first.work_off(2), alone);
  EXPECT_GT(first.kills(), 3);
  const FrameImage undisturbed = Forgetful(job, first.kept(), 0, false, planes).work_off(3);
  EXPECT_FALSE(same_bits(alone.filtered, undisturbed.filtered)) << "the history changes nothing";
  for (const int every : {1, 3})
    expect_same(Forgetful(job, first.kept(), every, false, planes).work_off(10 + every), undisturbed);
}

TEST(Recovery, EntriesThatDoNotFitTheFrameAreCutOff) {
  Folder folder;
  const Job job = small_job();
  RenderedFrame frame(job);
  const RenderTask task = std::get<RenderTask>(frame.begin().front());
  const Block block = rendered(task, frame.layout(), kNoise);
  Journal journal(folder.path() / "journal", "a frame");
  Accepted good{task, 1, {}, "worker", "class", 0.5, 0};
  journal.append(good, block.sums);
  const std::uint64_t end = journal.bytes();
  RenderTask wrong = task;
  wrong.samples = {64, 128};
  Accepted bad{wrong, 1, {}, "worker", "class", 0.5, 0};
  journal.append(bad, block.sums);
  journal.append(good, block.sums);
  const RecoveredFrame recovered = recover(job, journal, {});
  EXPECT_EQ(journal.bytes(), end);
  EXPECT_EQ(recovered.frame->outstanding().size() + 1, RenderedFrame(job).begin().size());
}

TEST(Recovery, ALookBeforeTheRoundIsCompleteIsCutOff) {
  Folder folder;
  Journal journal(folder.path() / "journal", "a frame");
  const std::uint64_t begin = journal.bytes();
  journal.append(Looked{1});
  recover(small_job(), journal, {});
  EXPECT_EQ(journal.bytes(), begin);
}

// The snapshot of a frame in its third round.
FrameSnapshot snapshot_of(const Job& job) {
  RenderedFrame frame(job);
  std::deque<Work> todo;
  const auto add = [&](const std::vector<Work>& work) { todo.insert(todo.end(), work.begin(), work.end()); };
  add(frame.begin());
  while (frame.image().rounds < 2) {
    const Work work = todo.front();
    todo.pop_front();
    if (const auto* render = std::get_if<RenderTask>(&work))
      add(frame.fold(rendered(*render, frame.layout(), kNoise)));
    else
      frame.stitch(std::get<FilterTask>(work),
                   filtered(std::get<FilterTask>(work), frame.filter_input(std::get<FilterTask>(work)), job));
    if (frame.round_complete()) add(frame.look({}));
  }
  return frame.snapshot();
}

TEST(Snapshot, OfAnotherJobOrDamagedIsRefused) {
  const Job job = small_job();
  const FrameSnapshot good = snapshot_of(job);
  EXPECT_NO_THROW(RenderedFrame(job, good));
  const auto refused = [&](auto change) {
    FrameSnapshot s = good;
    change(s);
    EXPECT_THROW(RenderedFrame(job, s), InputError);
  };
  refused([](FrameSnapshot& s) { s.round = 0; });
  refused([](FrameSnapshot& s) { s.round = 1; });
  refused([](FrameSnapshot& s) { s.have.pop_back(); });
  refused([](FrameSnapshot& s) { s.have[0] = 0; });
  refused([](FrameSnapshot& s) { s.have[0] = 24; });
  refused([](FrameSnapshot& s) { s.have[0] = -16; });
  refused([](FrameSnapshot& s) { s.want[0] = s.have[0] / 2; });
  refused([](FrameSnapshot& s) { s.want[0] = 1 << 20; });
  refused([](FrameSnapshot& s) { s.want = s.have; });
  refused([](FrameSnapshot& s) { s.looks.pop_back(); });
  refused([](FrameSnapshot& s) { s.states.pop_back(); });
  refused([](FrameSnapshot& s) { s.sums = {}; });
  refused([](FrameSnapshot& s) { s.sums = Image(s.sums.region(), s.sums.planes() + 1); });
  refused([](FrameSnapshot& s) { s.stitched = Image(grown(s.stitched.region(), 1), s.stitched.planes()); });
  Job other = job;
  other.render.size = {151, 90};
  EXPECT_THROW(RenderedFrame(other, good), InputError);
}

TEST(Snapshot, SaysTheSameOfAFrameMadeFromIt) {
  const Job job = small_job();
  const FrameSnapshot good = snapshot_of(job);
  const RenderedFrame frame(job, good);
  const FrameSnapshot again = frame.snapshot();
  EXPECT_EQ(again.round, good.round);
  EXPECT_EQ(again.have, good.have);
  EXPECT_EQ(again.want, good.want);
  EXPECT_EQ(again.states, good.states);
  EXPECT_EQ(again.error, good.error);
  EXPECT_TRUE(same_bits(again.sums, good.sums));
  EXPECT_TRUE(same_bits(again.stitched, good.stitched));
}

}  // namespace
}  // namespace tessera
