// SPDX-License-Identifier: Apache-2.0
// A farm as a service with its store, in the test's own thread, and workers in threads of theirs.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/farm/desk.h"
#include "coordinator/farm/farm.h"
#include "core/bundle.h"
#include "core/exr.h"
#include "proto/submission_codec.h"
#include "tests/farm/small_scene.h"
#include "tests/farm/test_farm.h"

namespace tessera::farm {

namespace fs = std::filesystem;

inline std::shared_ptr<const Scene> scene() {
  static const auto made = small_scene();
  return made;
}

inline TaskRunner& runner() {
  static const auto made = make_task_runner(scene_in_hand(scene()), DevicePool::open({}));
  return *made;
}

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
  // Ends the farm's life, and begins the next one, whenever a tenth more of the job is done, until it is
  // completed. `lives`: how many there were.
  void disturb(const JobName& name, int& lives) {
    double reached = 0;
    lives = 1;
    while (job(name).state != JobState::completed && lives < 12) {
      ASSERT_TRUE(comes(
          [&] { return job(name).fraction > reached + 0.1 || job(name).state == JobState::completed; }));
      reached = job(name).fraction;
      die();
      ++lives;
    }
    ASSERT_TRUE(comes_to(name, JobState::completed)) << events(name);
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

}  // namespace tessera::farm
