// SPDX-License-Identifier: Apache-2.0
// A farm in one thread and in virtual time: an Office, agents that work, break, hang and die by seed, and a
// road that loses, delays, repeats and reorders what they say.
#pragma once

#include <functional>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "proto/memory_transport.h"
#include "tests/sim/office.h"
#include "worker/agent.h"

namespace tessera::sim {

// When a worker dies without a word.
enum class Death : std::uint8_t {
  never,
  before_welcome,
  with_tasks_queued,
  at_work,
  before_sending,  // it has finished, and nobody will know
  after_sending,
};
inline constexpr int kDeaths = 6;

struct Habits {
  int slots = 1;
  Death death = Death::never;
  double break_chance = 0;  // that a task fails
  bool hangs = false;       // never finishes anything, but goes on talking
  Instant::duration work_min{std::chrono::milliseconds(1)}, work_max{std::chrono::milliseconds(80)};
  std::function<bool(TaskId)> breaks = {}, kills = {};  // tasks it cannot do, or does not survive
  std::string device_class = {}, name = {};
  std::function<Instant::duration(TaskId)> work = {};  // how long a task takes it; none: by chance, see above
};

// One worker: an Agent, and slots in which work takes virtual time.
class Actor {
 public:
  Actor(MemoryRoad& road, WorkerId id, const Habits& habits, std::uint64_t seed, Instant now)
      : id_(std::move(id)),
        habits_(habits),
        random_(seed),
        road_(road.join(id_)),
        agent_({.slots = habits.slots,
                .device_class = habits.device_class,
                .hello_first = Millis{50},
                .hello_last = Millis{400},
                .silence = Millis{1500},
                .name = habits.name}),
        slots_(habits.slots) {
    handle(Agent::Started{}, now);
  }

  const WorkerId& id() const { return id_; }
  bool dead() const { return dead_; }
  bool stopped() const { return stopped_; }
  bool busy() const { return std::ranges::any_of(slots_, &Slot::busy); }
  void stop(Instant now) {
    if (!dead_ && !stopped_) handle(Agent::StopRequested{}, now);
  }

  Instant next_event() const {
    Instant next = agent_.next_deadline().value_or(Instant::max());
    for (const Slot& s : slots_)
      if (s.busy) next = std::min(next, s.ends);
    return next;
  }

  void turn(Instant now) {
    while (!over()) {
      auto mail = road_->receive(now);
      if (!mail) break;
      handle(Agent::Told{std::move(mail->message)}, now);
    }
    for (int i = 0; i < habits_.slots && !over(); ++i)
      if (slots_[i].busy && slots_[i].ends <= now) end(i, now);
    if (const auto deadline = agent_.next_deadline(); !over() && deadline && *deadline <= now)
      handle(Agent::TimePassed{}, now);
  }

 private:
  struct Slot {
    bool busy = false, cancelled = false;
    Task task;
    Instant ends{}, began{};
  };

  bool over() const { return dead_ || stopped_; }
  double chance() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

  Instant::duration some_work() {
    const auto spread = static_cast<double>((habits_.work_max - habits_.work_min).count());
    return habits_.work_min + Instant::duration(std::int64_t(spread * chance()));
  }

  void die() {
    dead_ = true;
    road_.reset();
  }

  void end(int i, Instant now) {
    const Slot slot = std::exchange(slots_[i], {});
    if (slot.cancelled) return handle(Agent::Ended{i}, now);
    if (habits_.kills && habits_.kills(slot.task.id)) return die();
    if (chance() < habits_.break_chance || (habits_.breaks && habits_.breaks(slot.task.id)))
      return handle(Agent::Broke{i, "broke down", false}, now);
    ++finished_;
    if (habits_.death == Death::before_sending && finished_ == 2) return die();
    RenderDone answer = right_answer(slot.task);
    answer.seconds = std::chrono::duration<double>(now - slot.began).count();
    handle(Agent::Finished{i, std::move(answer)}, now);
    if (habits_.death == Death::after_sending && finished_ == 2) die();
  }

  void handle(Agent::Event event, Instant now) {
    for (Agent::Command& command : agent_.handle(std::move(event), now)) {
      if (over()) return;
      carry_out(command, now);
    }
    if (habits_.death == Death::before_welcome) die();
  }

  void carry_out(Agent::Command& command, Instant now) {
    if (auto* send = std::get_if<Agent::Send>(&command)) {
      const auto* beat = std::get_if<Heartbeat>(&send->message);
      const bool queued = beat && static_cast<int>(beat->held.size()) > habits_.slots;
      road_->send("coordinator", std::move(send->message));
      if (queued && habits_.death == Death::with_tasks_queued) die();
    } else if (const auto* start = std::get_if<Agent::Start>(&command)) {
      EXPECT_FALSE(slots_[start->slot].busy) << "a slot was given two tasks";
      if (habits_.death == Death::at_work && ++started_ == 2) return die();
      const Instant::duration work = habits_.work ? habits_.work(start->task.id) : some_work();
      slots_[start->slot] = {true, false, start->task, habits_.hangs ? Instant::max() : now + work, now};
    } else if (const auto* cancel = std::get_if<Agent::Cancel>(&command)) {
      EXPECT_TRUE(slots_[cancel->slot].busy) << "nothing to cancel";
      slots_[cancel->slot].cancelled = true;
      slots_[cancel->slot].ends = now + std::chrono::milliseconds(2);
    } else if (std::holds_alternative<Agent::Stop>(command)) {
      EXPECT_FALSE(busy()) << "stopped at work";
      stopped_ = true;
      road_.reset();
    }
  }

  WorkerId id_;
  Habits habits_;
  std::mt19937_64 random_;
  std::unique_ptr<Transport> road_;
  Agent agent_;
  std::vector<Slot> slots_;
  int started_ = 0, finished_ = 0;
  bool dead_ = false, stopped_ = false;
};

class Storm {
 public:
  Storm(std::uint64_t seed, const Weather& weather, const SchedulerOptions& options)
      : seed_(seed),
        random_(seed),
        road_(weather, [this] { return now_; }),
        end_(road_.join("coordinator")),
        office_(*end_, options, Millis{100}) {}

  Office& office() { return office_; }
  Instant now() const { return now_; }
  const std::vector<std::unique_ptr<Actor>>& actors() const { return actors_; }
  MemoryRoad& road() { return road_; }

  Actor& hire(const Habits& habits) {
    const WorkerId id = "worker-" + std::to_string(actors_.size());
    actors_.push_back(std::make_unique<Actor>(road_, id, habits, random_(), now_));
    return *actors_.back();
  }

  // Those who die are replaced by such a one, under a new name.
  void replace_the_dead_by(std::function<Habits()> habits) { replacement_ = std::move(habits); }

  // Something to be done at a time, e.g. to withdraw tasks.
  void at(Instant when, std::function<void()> act) { acts_.emplace(when, std::move(act)); }

  // Lives until `done` or `end`; false if `end` came first.
  bool run(const std::function<bool()>& done, Instant end) {
    while (!done()) {
      now_ = std::max(now_, next_event());
      if (now_ >= end) return false;
      while (!acts_.empty() && acts_.begin()->first <= now_) acts_.extract(acts_.begin()).mapped()();
      office_.turn(now_);
      for (std::size_t i = 0; i < actors_.size(); ++i) {  // by index: the dead are replaced meanwhile
        if (actors_[i]->dead() || actors_[i]->stopped()) continue;
        actors_[i]->turn(now_);
        if (actors_[i]->dead() && replacement_)
          at(now_ + std::chrono::milliseconds(20), [this] { hire(replacement_()); });
      }
      // Time always moves, a little: an event that is due is handled once.
      now_ += Instant::duration(1);
    }
    return true;
  }

  bool anyone_at_work() const {
    return std::ranges::any_of(actors_, [](const auto& a) { return !a->dead() && a->busy(); });
  }

  std::mt19937_64& random() { return random_; }
  double chance() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  int pick(int n) { return static_cast<int>(random_() % static_cast<std::uint64_t>(n)); }

 private:
  Instant next_event() const {
    Instant next = office_.scheduler().next_deadline().value_or(Instant::max());
    if (const auto arrival = road_.next_arrival()) next = std::min(next, *arrival);
    if (!acts_.empty()) next = std::min(next, acts_.begin()->first);
    for (const auto& actor : actors_)
      if (!actor->dead() && !actor->stopped()) next = std::min(next, actor->next_event());
    return next;
  }

  std::uint64_t seed_;
  std::mt19937_64 random_;
  Instant now_{};
  MemoryRoad road_;
  std::unique_ptr<Transport> end_;
  Office office_;
  std::vector<std::unique_ptr<Actor>> actors_;
  std::multimap<Instant, std::function<void()>> acts_;
  std::function<Habits()> replacement_;
};

}  // namespace tessera::sim
