// SPDX-License-Identifier: Apache-2.0
// The loop that makes decisions happen: mail in, scheduler and frame asked, commands carried out. One thread;
// only run() reads a clock.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "coordinator/frame.h"
#include "coordinator/progress.h"
#include "coordinator/scheduler.h"
#include "proto/transport.h"

namespace tessera {

struct CoordinatorOptions {
  SchedulerOptions scheduler;
  Millis heartbeat{1000};  // what workers are asked for; well below scheduler.silence
  // Jobs and tasks are numbered from here. A coordinator whose workers outlive it starts elsewhere in each
  // life, so that no old result is taken for a new one.
  std::uint64_t first_id = 1;
};

// How a job ended, or stands.
struct JobReport {
  FrameImage image;
  double seconds = 0;
  std::uint64_t dropped = 0;             // samples that were not finite
  std::set<std::string> device_classes;  // of the workers whose results are in
  std::optional<std::string> failure;    // set: the job failed, for this reason
  bool bad_input = false;                // and the reason is the scene or the job itself
};

struct JobWatcher {
  ProgressSink progress = {};  // called whenever something changed, but not more often than
  Millis interval{0};          // this
  std::function<void(const JobReport&)> snapshot = {};  // called after request_snapshot()
};

class Coordinator {
 public:
  // `road` is borrowed and outlives the coordinator.
  Coordinator(Transport& road, const CoordinatorOptions& options);
  ~Coordinator();

  // Runs one job to its end. Throws what validate(job) throws.
  JobReport run(const Job& job, const JobWatcher& watcher = {});

  // From any thread: end the job with the image of the last look; fail it; hand its state to the watcher.
  void interrupt();
  void fail(const std::string& reason);
  void request_snapshot();

 private:
  struct Active;

  void hear(Mail mail, Instant now);
  void tell(const Event& event, Instant now);
  void carry_out(const AssignTask&, Instant now);
  void carry_out(const RevokeTask&, Instant now);
  void carry_out(const Accept&, Instant now);
  void carry_out(const GiveUp&, Instant now);
  void carry_out(const Forget&, Instant now);
  void carry_out(const AskHello&, Instant now);
  void welcome(const WorkerId& from, const Hello& hello, Instant now);
  void answer(const WorkerId& from, const NeedJob& need, Instant now);
  template <class Result>
  void take(const WorkerId& from, Result& result, Instant now);
  bool fits(const RenderDone& result) const;
  bool fits(const FilterDone& result) const;

  void add(const std::vector<Work>& work, Instant now);
  void advance(Instant now);
  void dismiss(Instant now);
  Instant next_wake(Instant now) const;
  JobReport report(Instant now) const;

  Transport& road_;
  CoordinatorOptions options_;
  Scheduler scheduler_;
  std::unique_ptr<Active> active_;
  JobId next_job_;
  TaskId next_task_;
  std::map<WorkerId, std::string> device_classes_;
  std::atomic<bool> interrupted_ = false, snapshot_wanted_ = false;
  std::mutex failing_;  // guards failure_
  std::optional<std::string> failure_;
};

}  // namespace tessera
