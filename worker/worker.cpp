// SPDX-License-Identifier: Apache-2.0
#include "worker/worker.h"

#include <condition_variable>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "core/error.h"
#include "proto/clock.h"

namespace tessera {

// One thread a slot. What they have to report waits in `news` until the loop, woken, takes it.
class Worker::Slots {
 public:
  Slots(int count, Transport& road, TaskRunner& runner) : road_(road), runner_(runner), desks_(count) {
    for (int i = 0; i < count; ++i)
      threads_.emplace_back([this, i](const std::stop_token& token) { live(i, token); });
  }
  ~Slots() {
    for (Desk& desk : desks_) desk.cancel = true;
  }

  void start(Agent::Start&& start) {
    const std::lock_guard lock(mutex_);
    Desk& desk = desks_[start.slot];
    desk.cancel = false;
    desk.order = std::move(start);
    bell_.notify_all();
  }
  void cancel(int slot) { desks_[slot].cancel = true; }

  std::vector<Agent::Event> news() {
    const std::lock_guard lock(mutex_);
    return std::exchange(news_, {});
  }

 private:
  struct Desk {
    std::optional<Agent::Start> order;
    std::atomic<bool> cancel = false;
  };

  void live(int slot, const std::stop_token& token) {
    for (;;) {
      Agent::Start order;
      {
        std::unique_lock lock(mutex_);
        if (!bell_.wait(lock, token, [&] { return desks_[slot].order.has_value(); })) return;
        order = *std::exchange(desks_[slot].order, {});
      }
      Agent::Event event = attempt(order, desks_[slot].cancel);
      {
        const std::lock_guard lock(mutex_);
        news_.push_back(std::move(event));
      }
      road_.wake();
    }
  }

  // The edge of a task: whatever goes wrong in it costs a message.
  Agent::Event attempt(const Agent::Start& order, const std::atomic<bool>& cancel) {
    const auto broke = [&](std::string reason, bool bad_input) -> Agent::Event {
      if (cancel) return Agent::Ended{order.slot};
      return Agent::Broke{order.slot, std::move(reason), bad_input};
    };
    const Instant begin = clock_now();
    try {
      TaskResult result = runner_.run(*order.job, order.task, order.input, cancel);
      const double seconds = seconds_between(begin, clock_now());
      std::visit([&](auto& r) { r.seconds = seconds; }, result);
      return Agent::Finished{order.slot, std::move(result)};
    } catch (const Error& error) {
      return broke(error.what(), error.code() == ExitCode::bad_input);
    } catch (const std::bad_alloc&) {
      return broke("out of memory", false);
    } catch (const std::exception& error) {
      return broke(error.what(), false);
    } catch (...) {
      return broke("failed, but did not say why", false);
    }
  }

  Transport& road_;
  TaskRunner& runner_;
  std::mutex mutex_;  // guards the orders and the news
  std::condition_variable_any bell_;
  std::vector<Desk> desks_;
  std::vector<Agent::Event> news_;
  std::vector<std::jthread> threads_;  // last: they end before what they use
};

Worker::Worker(AgentOptions options, Transport& road, TaskRunner& runner)
    : road_(road), agent_(options), slots_(std::make_unique<Slots>(options.slots, road, runner)) {}

Worker::~Worker() = default;

WorkerEnd Worker::run() {
  const auto handle = [this](Agent::Event&& event) {
    for (Agent::Command& command : agent_.handle(std::move(event), clock_now()))
      carry_out(std::move(command));
  };
  handle(Agent::Started{});
  bool leaving = false;
  while (!end_) {
    const Instant far = clock_now() + std::chrono::hours(1);
    std::optional<Mail> mail = road_.receive(agent_.next_deadline().value_or(far));
    for (Agent::Event& event : slots_->news()) handle(std::move(event));
    if (mail) handle(Agent::Told{std::move(mail->message)});
    if (stop_ && !std::exchange(leaving, true)) handle(Agent::StopRequested{});
    const std::optional<Instant> deadline = agent_.next_deadline();
    if (deadline && clock_now() >= *deadline) handle(Agent::TimePassed{});
  }
  return *std::exchange(end_, {});
}

void Worker::stop() {
  stop_ = true;
  road_.wake();
}

void Worker::carry_out(Agent::Command&& command) {
  if (auto* send = std::get_if<Agent::Send>(&command)) road_.send("coordinator", std::move(send->message));
  if (auto* start = std::get_if<Agent::Start>(&command)) slots_->start(std::move(*start));
  if (const auto* cancel = std::get_if<Agent::Cancel>(&command)) slots_->cancel(cancel->slot);
  if (const auto* stop = std::get_if<Agent::Stop>(&command)) end_ = WorkerEnd{stop->why, stop->reason};
}

}  // namespace tessera
