// SPDX-License-Identifier: Apache-2.0
// A coordinator without pictures: a Scheduler on a road, tasks whose right answers are known, and a ledger of
// what was accepted. It checks as it goes that nothing is accepted twice or after it was withdrawn.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <vector>

#include "coordinator/scheduler.h"
#include "proto/transport.h"
#include "tests/sim/audit.h"

namespace tessera::sim {

inline Task task_of(TaskId id, JobId job = 1) {
  const int x = static_cast<int>(id % 1000);
  return {id, job, RenderTask{{x, 0, x + 1, 1}, {0, 8}}};
}

// What a right answer to the task holds.
inline float answer_to(TaskId id) { return static_cast<float>(id) * 0.5f + 1.0f; }

inline RenderDone right_answer(const Task& task) {
  return {.block = {std::get<RenderTask>(task.work).samples,
                    Image(std::get<RenderTask>(task.work).region, 4, answer_to(task.id))}};
}

class Office {
 public:
  Office(Transport& road, const SchedulerOptions& options, Millis heartbeat)
      : road_(road), scheduler_(options), heartbeat_(heartbeat) {}

  void submit(const std::vector<Task>& tasks, Instant now) {
    Submitted event;
    for (const Task& t : tasks) event.tasks.push_back({t.id, t.job});
    submit(event, now);
  }

  void submit(const Submitted& event, Instant now) {
    for (const Wish& wish : event.tasks) tasks_[wish.task] = task_of(wish.task, wish.job);
    handle(event, now);
  }

  void withdraw(const std::vector<TaskId>& tasks, Instant now) {
    withdrawn_.insert(tasks.begin(), tasks.end());
    handle(WithdrawnTasks{tasks}, now);
  }

  // Reads all mail that is there at `now`; then lets time pass.
  void turn(Instant now) {
    while (auto mail = road_.receive(now)) hear(std::move(*mail), now);
    if (const auto deadline = scheduler_.next_deadline(); deadline && *deadline <= now)
      handle(TimePassed{}, now);
  }

  void hear(Mail&& mail, Instant now) {
    const WorkerId& from = mail.from;
    if (const auto* m = std::get_if<Hello>(&mail.message)) {
      road_.send(from, Welcome{kProtocolVersion, heartbeat_, heartbeat_});
      handle(Joined{from, m->slots, m->device_class, m->name}, now);
    } else if (const auto* beat = std::get_if<Heartbeat>(&mail.message)) {
      handle(Heard{from, beat->held}, now);
    } else if (const auto* need = std::get_if<NeedJob>(&mail.message)) {
      handle(Heard{from}, now);
      if (closed)
        road_.send(from, JobOver{need->id});
      else
        road_.send(from, JobOffer{need->id, Job{}});
    } else if (auto* done = std::get_if<RenderDone>(&mail.message)) {
      result_ = std::move(done->block);
      handle(Done{from, done->task, done->attempt, done->seconds}, now);
    } else if (const auto* failed = std::get_if<TaskFailed>(&mail.message)) {
      handle(Failed{from, failed->task, failed->attempt, failed->reason, failed->bad_input}, now);
    } else if (std::holds_alternative<Goodbye>(mail.message)) {
      handle(Left{from}, now);
    } else {
      ADD_FAILURE() << "a worker said what only coordinators say";
    }
  }

  void handle(const Event& event, Instant now) {
    const std::vector<Command> commands = scheduler_.handle(event, now);
    if (audited) Audit(scheduler_).check(commands);
    for (const Command& command : commands) carry_out(command);
  }

  std::size_t open() const { return tasks_.size() - accepted.size() - given_up.size() - withdrawn_open(); }
  const Scheduler& scheduler() const { return scheduler_; }

  std::set<TaskId> accepted;
  std::map<TaskId, GiveUp> given_up;
  std::vector<WorkerId> forgotten;
  std::uint64_t assigned = 0, revoked = 0, class_changes = 0;
  std::set<std::string> set_aside;  // names that ever were
  bool audited = false;             // the books are checked after each event
  bool closed = false;              // answers NeedJob with JobOver

 private:
  std::size_t withdrawn_open() const {
    return std::ranges::count_if(withdrawn_,
                                 [this](TaskId t) { return !accepted.contains(t) && !given_up.contains(t); });
  }

  void carry_out(const Command& command) {
    if (const auto* a = std::get_if<AssignTask>(&command)) {
      ++assigned;
      EXPECT_FALSE(accepted.contains(a->task) || withdrawn_.contains(a->task)) << "assigned after its end";
      road_.send(a->worker, Assign{tasks_.at(a->task), a->attempt, {}});
    } else if (const auto* r = std::get_if<RevokeTask>(&command)) {
      ++revoked;
      road_.send(r->worker, Revoke{r->task, r->attempt});
    } else if (const auto* accept = std::get_if<Accept>(&command)) {
      EXPECT_TRUE(accepted.insert(accept->task).second) << "accepted twice";
      EXPECT_FALSE(withdrawn_.contains(accept->task)) << "accepted after it was withdrawn";
      EXPECT_FALSE(given_up.contains(accept->task)) << "accepted after it was given up";
      const Image right = right_answer(tasks_.at(accept->task)).block.sums;
      EXPECT_TRUE(same_bits(result_.sums, right)) << "another task's result";
    } else if (const auto* g = std::get_if<GiveUp>(&command)) {
      EXPECT_TRUE(given_up.emplace(g->task, *g).second) << "given up twice";
    } else if (const auto* f = std::get_if<Forget>(&command)) {
      forgotten.push_back(f->worker);
    } else if (const auto* ask = std::get_if<AskHello>(&command)) {
      road_.send(ask->worker, Unknown{});
    } else if (const auto* aside = std::get_if<SetAside>(&command)) {
      set_aside.insert(aside->name);
    } else if (std::holds_alternative<ClassChanged>(command)) {
      ++class_changes;
    }
  }

  Transport& road_;
  Scheduler scheduler_;
  Millis heartbeat_;
  std::map<TaskId, Task> tasks_;
  std::set<TaskId> withdrawn_;
  Block result_;
};

}  // namespace tessera::sim
