// SPDX-License-Identifier: Apache-2.0
// The first promise: one image, bit for bit, whoever works, however the work is cut, and whatever the road
// does.
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/plan.h"
#include "tests/farm/small_scene.h"
#include "tests/farm/test_farm.h"
#include "worker/denoise/runner.h"
#include "worker/render/render.h"

namespace tessera::farm {
namespace {

class OneImage : public WithDevice {
 protected:
  static const std::shared_ptr<const Scene>& scene() {
    static const auto scene = small_scene();
    return scene;
  }
  static TaskRunner& runner() {
    static const auto runner = make_task_runner(scene_in_hand(scene()), DevicePool::open({}));
    return *runner;
  }
  // What every farm must deliver: one worker, one tile, a quiet road.
  static const FrameImage& expected() {
    static const FrameImage image = [] {
      Job job = small_job(*scene());
      job.tile = job.render.size;
      job.task_samples = 1 << 30;
      return over_zmq(job, 1).image;
    }();
    return image;
  }

  static JobReport over_zmq(const Job& job, int workers, const std::string& endpoint = "inproc://farm") {
    return farm::over_zmq(runner(), workers, endpoint, [&](Coordinator& c) { return c.run(job); });
  }

  static void expect_the_image(const JobReport& report, const std::string& how) {
    ASSERT_FALSE(report.failure) << how << ": " << *report.failure;
    EXPECT_TRUE(same_bits(report.image.filtered, expected().filtered)) << how;
    EXPECT_TRUE(same_bits(report.image.sums, expected().sums)) << how;
    EXPECT_EQ(report.image.states, expected().states) << how;
    EXPECT_EQ(report.image.stop, expected().stop) << how;
  }
};

TEST_F(OneImage, EqualsRenderingAndFilteringTheWholeFrameWithoutAFarm) {
  Job job = small_job(*scene());
  job.acceptance.relmse.reset();
  const JobReport farm = over_zmq(job, 2);
  RenderSettings settings = job.render;
  settings.aovs = film_aovs(job);
  const Block block = render(*prepare(scene()), settings, job.frame, job.region(), {0, 32});
  EXPECT_TRUE(same_bits(farm.image.sums, block.sums));
  const auto device = Device::open("");
  const Filtered whole = filter_task(*device, job.filter, block.sums, FilmLayout(settings.aovs),
                                     {job.region(), job.region()}, job.region());
  EXPECT_TRUE(
      std::equal(farm.image.filtered.data().begin(), farm.image.filtered.data().end(), whole.data().begin()));
}

TEST_F(OneImage, IsTheSameForOneTwoAndFiveWorkers) {
  for (const int workers : {1, 2, 5})
    expect_the_image(over_zmq(small_job(*scene()), workers), std::to_string(workers) + " workers");
}

TEST_F(OneImage, IsTheSameOverTcpAndIpc) {
  const std::string socket = "ipc://" + ::testing::TempDir() + "tessera-" + std::to_string(getpid());
  expect_the_image(over_zmq(small_job(*scene()), 2, socket), "ipc");
  expect_the_image(over_zmq(small_job(*scene()), 2, "tcp://127.0.0.1:*"), "tcp");
}

TEST_F(OneImage, IsTheSameForEveryTileAndTaskSize) {
  for (const Size tile : {Size{16, 16}, Size{37, 53}, Size{64, 64}, Size{9, 70}})
    for (const int task_samples : {1, 1 << 12}) {
      Job job = small_job(*scene());
      job.tile = tile;
      job.task_samples = task_samples;
      expect_the_image(over_zmq(job, 2), std::to_string(tile.width) + "x" + std::to_string(tile.height));
    }
}

TEST_F(OneImage, OfACropIsThatPartOfItsOwnFrame) {
  Job job = small_job(*scene());
  job.acceptance.relmse.reset();
  job.filter = parse_filter("none");
  const Image whole = over_zmq(job, 1).image.filtered;
  job.crop = Region{13, 9, 70, 66};
  EXPECT_TRUE(same_bits(over_zmq(job, 2).image.filtered, cropped(whole, *job.crop)));
}

TEST_F(OneImage, IsTheSameThroughDozensOfStorms) {
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const Job job = small_job(*scene());
    expect_the_image(through_storm(runner(), seed, [&](Coordinator& c) { return c.run(job); }),
                     "storm " + std::to_string(seed));
  }
}

template <class Kind>
Cable::Watch nth(int n) {
  return [n, seen = 0](const Message& message) mutable {
    return std::holds_alternative<Kind>(message) && ++seen == n;
  };
}

TEST_F(OneImage, IsTheSameWhenAWorkerDiesInAnyPhase) {
  struct Phase {
    const char* name;
    Cable::Watch sending, receiving;
  };
  const std::vector<Phase> phases{{"before its first word", nth<Hello>(1), {}},
                                  {"when welcomed", {}, nth<Welcome>(1)},
                                  {"with its first task", {}, nth<Assign>(1)},
                                  {"with a task of a later round", {}, nth<Assign>(8)},
                                  {"before a result leaves", nth<RenderDone>(2), {}},
                                  {"before a filtered tile leaves", nth<FilterDone>(1), {}},
                                  {"at a heartbeat", nth<Heartbeat>(1), {}}};
  for (const Phase& phase : phases) {
    MemoryRoad road(Weather{.seed = 1});
    const auto end = road.join("coordinator");
    CoordinatorOptions options = impatient();
    options.heartbeat = Millis{2};  // so that there is one in so short a job
    Coordinator coordinator(*end, options);
    auto cable = std::make_unique<Cable>(road.join("doomed"), phase.sending, phase.receiving);
    const Cable& watched = *cable;
    Hand doomed(std::move(cable), runner());
    std::unique_ptr<Hand> survivor;  // comes when the other is dead
    const auto rescue = [&](const Progress&) {
      if (watched.was_cut() && !survivor) survivor = std::make_unique<Hand>(road.join("survivor"), runner());
    };
    expect_the_image(coordinator.run(small_job(*scene()), {.progress = rescue}), phase.name);
    EXPECT_TRUE(watched.was_cut()) << phase.name;
  }
}

TEST_F(OneImage, IsTheSameWhenAWorkerComesLate) {
  ZmqContext context;
  ZmqRouter router(context, {"inproc://farm"});
  Coordinator coordinator(router, {});
  std::unique_ptr<Hand> late;
  Hand early(std::make_unique<ZmqDealer>(context, "inproc://farm", "early"), runner());
  const auto join_later = [&](const Progress& p) {
    if (!late && p.samples_done > 0)
      late = std::make_unique<Hand>(std::make_unique<ZmqDealer>(context, "inproc://farm", "late"), runner());
  };
  expect_the_image(coordinator.run(small_job(*scene()), {.progress = join_later}), "late");
}

}  // namespace
}  // namespace tessera::farm
