// SPDX-License-Identifier: Apache-2.0
// The first promise for shots: the same frames, bit for bit, whoever works on which of them, however they are
// cut and however many are under way; and what becomes of a shot when a frame of it fails.
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/farm/small_scene.h"
#include "tests/farm/test_farm.h"

namespace tessera::farm {
namespace {

// The small scene seen from a cart that races past it, while one of its floors slides the other way.
std::shared_ptr<const Scene> moving_scene() {
  Scene scene = *small_scene();
  const auto line = [](const Vec3& from, const Vec3& to) {
    Track track{{0.0f, 1.0f}, {Matrix(), Matrix()}};
    track.poses[0].setTranslation(from);
    track.poses[1].setTranslation(to);
    return track;
  };
  scene.tracks = {line({-6, 0, 0}, {18, 0.5f, 1}), line({4, 0.2f, 0}, {-12, 0.2f, 2})};
  scene.cameras.front().track = 0;
  scene.objects = {{.name = "sliding floor", .track = 1}};
  scene.instances.back().object = 0;
  return std::make_shared<const Scene>(std::move(scene));
}

using Frames = std::vector<JobReport>;

class OneShot : public WithDevice, public ::testing::WithParamInterface<const char*> {
 protected:
  static const std::shared_ptr<const Scene>& scene() {
    static const auto scene = moving_scene();
    return scene;
  }
  static TaskRunner& runner() {
    static const auto runner = make_task_runner(scene_in_hand(scene()), DevicePool::open({}));
    return *runner;
  }

  // Frames 5 to 8, then, after a cut, 12 and 13.
  static Shot shot() {
    Shot shot;
    for (const int frame : {5, 6, 7, 8, 12, 13}) {
      Job& job = shot.frames.emplace_back(small_job(*scene()));
      job.filter = parse_filter(GetParam());
      job.frame = frame;
    }
    return shot;
  }
  static Frames run(Coordinator& coordinator, const Shot& shot) {
    Frames frames(shot.frames.size());
    coordinator.run(shot, {.finished = [&](std::size_t i, const JobReport& r) { frames[i] = r; }});
    return frames;
  }
  static Frames over_zmq(const Shot& shot, int workers) {
    return farm::over_zmq(runner(), workers, "inproc://farm", [&](Coordinator& c) { return run(c, shot); });
  }
  // One worker, one frame after the other, in one tile each.
  static const Frames& expected() {
    static std::map<std::string, Frames> all;
    Frames& frames = all[GetParam()];
    if (!frames.empty()) return frames;
    Shot plain = shot();
    plain.in_flight = 1;
    for (Job& job : plain.frames) job.tile = job.render.size, job.task_samples = 1 << 30;
    return frames = over_zmq(plain, 1);
  }

  static void expect_the_frames(const Frames& frames, const std::string& how) {
    ASSERT_EQ(frames.size(), expected().size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      ASSERT_FALSE(frames[i].failure) << how << ", " << i << ": " << *frames[i].failure;
      EXPECT_TRUE(same_bits(frames[i].image.filtered, expected()[i].image.filtered)) << how << ", " << i;
      EXPECT_TRUE(same_bits(frames[i].image.sums, expected()[i].image.sums)) << how << ", " << i;
      EXPECT_TRUE(same_bits(*frames[i].kept, *expected()[i].kept)) << how << ", " << i;
      EXPECT_EQ(frames[i].image.states, expected()[i].image.states) << how << ", " << i;
      EXPECT_EQ(frames[i].continued, i != 0 && i != 4) << how << ", " << i;
    }
  }
};

TEST_P(OneShot, IsTheSameForAnyNumberOfWorkersAndOfFramesUnderWay) {
  for (const int workers : {1, 2, 5})
    for (const int in_flight : {1, 2, 6}) {
      Shot shot = OneShot::shot();
      shot.in_flight = in_flight;
      expect_the_frames(over_zmq(shot, workers),
                        std::to_string(workers) + " workers, " + std::to_string(in_flight));
    }
}

TEST_P(OneShot, IsTheSameForEveryTile) {
  for (const Size tile : {Size{16, 16}, Size{37, 53}, Size{9, 70}}) {
    Shot shot = OneShot::shot();
    for (Job& job : shot.frames) job.tile = tile;
    expect_the_frames(over_zmq(shot, 2), std::to_string(tile.width));
  }
}

TEST_P(OneShot, IsTheSameThroughStorms) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    expect_the_frames(through_storm(runner(), seed, [](Coordinator& c) { return run(c, shot()); }),
                      "storm " + std::to_string(seed));
  }
}

TEST_P(OneShot, IsTheSameWhenTheWorkerDiesBetweenFramesAndAnotherComes) {
  MemoryRoad road(Weather{.seed = 1});
  const auto end = road.join("coordinator");
  Coordinator coordinator(*end, impatient());
  auto first = std::make_unique<Hand>(road.join("first"), runner());
  std::unique_ptr<Hand> second;
  Frames frames(6);
  coordinator.run(shot(), {.finished = [&](std::size_t i, const JobReport& r) {
                    frames[i] = r;
                    if (i == 1) first.reset(), second = std::make_unique<Hand>(road.join("second"), runner());
                  }});
  expect_the_frames(frames, "two lives");
}

TEST_P(OneShot, TakenUpInTheMiddleItIsTheSame) {
  Shot rest = shot();
  rest.frames.erase(rest.frames.begin(), rest.frames.begin() + 2);
  rest.histories[0] = expected()[1].kept;
  const Frames frames = over_zmq(rest, 2);
  for (std::size_t i = 0; i < frames.size(); ++i)
    EXPECT_TRUE(same_bits(frames[i].image.filtered, expected()[i + 2].image.filtered)) << i;
}

TEST_P(OneShot, AfterACutNothingOfTheFrameBeforeIsSeen) {
  Shot alone = shot();
  alone.frames.erase(alone.frames.begin(), alone.frames.begin() + 4);
  const Frames frames = over_zmq(alone, 1);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_TRUE(same_bits(frames[i].image.filtered, expected()[i + 4].image.filtered)) << i;
  EXPECT_FALSE(same_bits(frames[1].image.filtered, over_zmq({{alone.frames[1]}}, 1)[0].image.filtered))
      << "the frame behind it does go by it";
}

INSTANTIATE_TEST_SUITE_P(Filters, OneShot,
                         ::testing::Values("svgf:levels=2,history=on", "atrous:levels=2,history=on",
                                           "bmfr:block=8,history=on,taa=on"));

// Renders nothing of some frames.
class FailingRunner : public TaskRunner {
 public:
  explicit FailingRunner(TaskRunner& good) : good_(good) {}
  TaskResult run(const Job& job, const Task& task, const FilterInput& input,
                 const std::atomic<bool>& cancel) override {
    if (job.frame == 6) throw InputError("scene.json:/cameras/0", "is inside a wall", "a camera outside");
    return good_.run(job, task, input, cancel);
  }

 private:
  TaskRunner& good_;
};

TEST_P(OneShot, AFrameThatFailsLosesNoneOfTheOthersAndTheNextStartsAnew) {
  FailingRunner failing(runner());
  MemoryRoad road(Weather{.seed = 1});
  const auto end = road.join("coordinator");
  Coordinator coordinator(*end, impatient());
  Hand hand(road.join("worker"), failing);
  const Frames frames = run(coordinator, shot());
  ASSERT_TRUE(frames[1].failure);
  EXPECT_NE(frames[1].failure->find("is inside a wall"), std::string::npos);
  EXPECT_TRUE(frames[1].bad_input);
  for (const std::size_t good : {0u, 4u, 5u})
    EXPECT_TRUE(same_bits(frames[good].image.filtered, expected()[good].image.filtered)) << good;
  EXPECT_FALSE(frames[2].failure);
  EXPECT_FALSE(frames[2].continued);
  EXPECT_TRUE(frames[3].continued);
}

TEST_P(OneShot, InterruptedItEndsWhatIsUnderWayAndBeginsNoMore) {
  ZmqContext context;
  ZmqRouter router(context, {"inproc://farm"});
  Coordinator coordinator(router, {});
  Hand hand(std::make_unique<ZmqDealer>(context, "inproc://farm", "worker"), runner());
  std::vector<std::size_t> ended;
  coordinator.run(shot(), {.finished = [&](std::size_t i, const JobReport& r) {
                    ended.push_back(i);
                    if (i == 0) coordinator.interrupt();
                    EXPECT_EQ(r.image.stop == StopReason::interrupted, i > 0) << i;
                  }});
  EXPECT_EQ(ended.size(), 2u) << "the one that was told, and the one under way";
}

}  // namespace
}  // namespace tessera::farm
