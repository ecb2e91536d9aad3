// SPDX-License-Identifier: Apache-2.0
// Looks into a scheduler's books after an event: whether they agree with each other, and whether what was
// given out was whose turn it was. By looking at everything, not by the lists that the scheduler goes by.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "coordinator/scheduler.h"

namespace tessera {

class Audit {
 public:
  explicit Audit(const Scheduler& s) : roster_(s.roster_), ledger_(s.ledger_), endgame_(s.options_.endgame) {}

  void check(const std::vector<Command>& commands) const {
    for (const auto& [id, task] : ledger_.tasks_) check(*task);
    for (const auto& [id, job] : ledger_.jobs_) check(job);
    for (const auto& [id, worker] : roster_.workers()) check(worker);
    std::set<TaskId> taken;  // from other workers, or second copies: they did not wait
    for (const Command& c : commands) {
      if (const auto* revoked = std::get_if<RevokeTask>(&c)) taken.insert(revoked->task);
      const auto* given = std::get_if<AssignTask>(&c);
      if (given && !taken.contains(given->task)) check(*given);
    }
  }

 private:
  using Task = book::Task;
  using Worker = book::Worker;

  static auto place(const Task& t) { return std::tuple(t.job->standing.rank, t.order); }
  bool waits_for(const Task& t, const Worker& w) const {
    return t.leases.empty() && !t.job->paused && roster_.may_have(w, book::terms_of(t));
  }

  void check(const Task& t) const {
    EXPECT_LE(t.leases.size(), 2);
    EXPECT_EQ(t.leases.empty(), t.line != nullptr)
        << "task " << t.id << " is lost, or waits while it is done";
    for (const book::Lease& lease : t.leases) {
      const Worker& w = *lease.worker;
      EXPECT_TRUE(w.able()) << w.id << " holds a task, but should have none";
      EXPECT_TRUE((lease.running ? w.running : w.queued).contains(lease.order));
      EXPECT_TRUE(t.avoid.empty() || (t.avoid != w.id && t.avoid != w.name->name))
          << "given to whom it avoids";
      EXPECT_TRUE(!t.filter || w.device_class == book::class_for(t)) << "two classes filter one frame";
      EXPECT_TRUE(!t.only || w.device_class == t.only);
    }
  }

  void check(const book::Job& job) const {
    for (const auto& [key, line] : job.lines)
      EXPECT_EQ(line.lane != nullptr, !line.tasks.empty() && !job.paused) << "job " << job.id;
    EXPECT_FALSE(job.filter_class && job.filter_class->able.empty()) << "nobody can filter job " << job.id;
  }

  void check(const Worker& w) const {
    EXPECT_LE(static_cast<int>(w.running.size()), std::max(w.slots, w.held()));
    EXPECT_TRUE(w.queued.empty() || static_cast<int>(w.running.size()) >= w.slots) << w.id;
    double cost = 0, booked = w.held_cost[0] + w.held_cost[1];
    std::uint64_t bytes = 0;
    for (const auto& [order, task] : w.running) cost += task->cost;
    for (const auto& [order, task] : w.queued) cost += task->cost, bytes += task->bytes;
    EXPECT_DOUBLE_EQ(cost, booked);
    EXPECT_EQ(bytes, w.queued_bytes);
    if (!w.able() || !w.idle() || roster_.on_trial(w)) return;
    for (const auto& [id, t] : ledger_.tasks_) {
      EXPECT_FALSE(waits_for(*t, w)) << w.id << " is idle, and task " << id << " waits";
      const book::Lease* first = t->leases.begin();
      const bool lies = t->leases.size() == 1 && !first->running && first->worker != &w;
      EXPECT_FALSE(endgame_ && lies && roster_.may_have(w, book::terms_of(*t)))
          << w.id << " is idle, and task " << id << " lies in the queue of " << first->worker->id;
    }
  }

  // What waits now waited when this was given.
  void check(const AssignTask& given) const {
    const auto found = ledger_.tasks_.find(given.task);
    if (found == ledger_.tasks_.end()) return;
    const Task& task = *found->second;
    const Standing& standing = task.job->standing;
    if (task.leases.size() != 1) return;
    const Worker& worker = *task.leases.begin()->worker;
    for (const auto& [id, other] : ledger_.tasks_) {
      if (!waits_for(*other, worker)) continue;
      // Its class may have been chosen since, and whether there is anybody else for it depends on that.
      if (other->filter && !other->failures.empty()) continue;
      EXPECT_LE(other->job->standing.band, standing.band)
          << id << " comes before " << task.id << ": its band";
      const bool same_flow =
          other->job->standing.band == standing.band && other->job->standing.flow == standing.flow;
      EXPECT_TRUE(!same_flow || place(task) < place(*other))
          << id << " comes before " << task.id << ": its rank";
    }
  }

  const Roster& roster_;
  const Ledger& ledger_;
  bool endgame_;
};

}  // namespace tessera
