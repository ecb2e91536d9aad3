// SPDX-License-Identifier: Apache-2.0
// Real coordinators and workers in threads, over ZeroMQ or over a road with weather, and cables that can be
// cut.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/coordinator.h"
#include "proto/clock.h"
#include "proto/memory_transport.h"
#include "proto/zmq_transport.h"
#include "worker/task_runner.h"

namespace tessera::farm {

// A transport whose cable may be cut: from then on nothing goes through, either way.
class Cable : public Transport {
 public:
  using Watch = std::function<bool(const Message&)>;  // true: cut here
  explicit Cable(std::unique_ptr<Transport> road, Watch cut_before_sending = {},
                 Watch cut_after_receiving = {})
      : road_(std::move(road)),
        sending_(std::move(cut_before_sending)),
        receiving_(std::move(cut_after_receiving)) {}

  void send(const Peer& to, Message message) override {
    if (sending_ && sending_(message)) cut_ = true;
    if (!cut_) road_->send(to, std::move(message));
  }
  std::optional<Mail> receive(Instant until) override {
    std::optional<Mail> mail = road_->receive(until);
    if (mail && receiving_ && receiving_(mail->message)) cut_ = true;
    return cut_ ? std::nullopt : std::move(mail);
  }
  void wake() override { road_->wake(); }
  bool was_cut() const { return cut_; }

 private:
  std::unique_ptr<Transport> road_;
  Watch sending_, receiving_;
  std::atomic<bool> cut_ = false;
};

// A worker in a thread of its own; gone when destroyed.
class Hand {
 public:
  Hand(std::unique_ptr<Transport> road, TaskRunner& runner, int slots = 1)
      : road_(std::move(road)),
        worker_(
            {.slots = slots, .hello_first = Millis{20}, .hello_last = Millis{100}, .silence = Millis{1000}},
            *road_, runner),
        thread_([this] { worker_.run(); }) {}
  ~Hand() {
    worker_.stop();
    thread_.join();
  }

 private:
  std::unique_ptr<Transport> road_;
  Worker worker_;
  std::jthread thread_;
};

// Impatient, so that what was lost is noticed within a test's time.
inline CoordinatorOptions impatient() {
  CoordinatorOptions options;
  options.scheduler.silence = Millis{1500};
  options.scheduler.grace = Millis{300};
  options.scheduler.max_attempts = 1000;
  options.heartbeat = Millis{50};
  return options;
}

// Tests that filter.
class WithDevice : public ::testing::Test {
 protected:
  void SetUp() override {
    if (list_devices().empty()) GTEST_SKIP() << "no OpenCL device on this machine";
  }
};

// What `work` makes of a coordinator with so many workers of one slot, over ZeroMQ.
template <typename Work>
auto over_zmq(TaskRunner& runner, int workers, const std::string& endpoint, Work work) {
  ZmqContext context;
  ZmqRouter router(context, {endpoint});
  Coordinator coordinator(router, {});
  std::vector<std::unique_ptr<Hand>> hands;
  for (int i = 0; i < workers; ++i)
    hands.push_back(std::make_unique<Hand>(
        std::make_unique<ZmqDealer>(context, router.endpoints().front(), "worker-" + std::to_string(i)),
        runner));
  return work(coordinator);
}

// The same with three impatient ones, over a road that loses, repeats and delays.
template <typename Work>
auto through_storm(TaskRunner& runner, std::uint64_t seed, Work work) {
  MemoryRoad road({.seed = seed, .loss = 0.05, .repeat = 0.05, .delay_max = std::chrono::milliseconds(4)});
  const auto end = road.join("coordinator");
  Coordinator coordinator(*end, impatient());
  std::vector<std::unique_ptr<Hand>> hands;
  for (int i = 0; i < 3; ++i)
    hands.push_back(std::make_unique<Hand>(road.join("worker-" + std::to_string(i)), runner));
  return work(coordinator);
}

}  // namespace tessera::farm
