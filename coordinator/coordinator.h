// SPDX-License-Identifier: Apache-2.0
// The loop that makes decisions happen: mail in, scheduler and frames asked, commands carried out. Any number
// of shots at a time, each of any number of frames. One thread; only run() and turn() read a clock.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <variant>

#include "coordinator/checks.h"
#include "coordinator/frame.h"
#include "coordinator/held_questions.h"
#include "coordinator/keeper.h"
#include "coordinator/report.h"
#include "coordinator/scheduler.h"
#include "coordinator/shot.h"
#include "proto/transport.h"

namespace tessera {

struct CoordinatorOptions {
  SchedulerOptions scheduler;
  Millis heartbeat{1000};  // what workers are asked for at work; well below scheduler.silence
  // And with nothing in hand, when nothing is lost if one is missed.
  Millis idle_heartbeat() const {
    return std::max(heartbeat, scheduler.silence * scheduler.idle_patience * 4 / 5);
  }
  // Jobs and tasks are numbered from here. A coordinator whose workers outlive it starts elsewhere in each
  // life, so that no old result is taken for a new one.
  std::uint64_t first_id = 1;
  // Answers what commands ask. None: they are denied.
  std::function<Reply(const Question&, const Identity& who)> answer = {};
  // Whether an answer now would say what who asks has been told: then it waits for news(), or kHold. None:
  // everything is answered at once.
  std::function<bool(const Question&)> may_wait = {};
};

using ShotId = std::uint64_t;  // unique in a coordinator's life, ascending

// A worker as it is known here.
struct WorkerRecord {
  std::string name, device_class;
  int slots = 1;
  std::uint64_t done = 0, failed = 0;         // tasks
  double seconds = 0;                         // of work that was accepted
  std::uint64_t bytes_in = 0, bytes_out = 0;  // of pixels
  bool present = true;  // else it left, and is remembered for results that are still under way
};

// Since the coordinator began.
struct WorkCounts {
  std::uint64_t pixel_samples = 0;            // of accepted tasks
  std::uint64_t bytes_in = 0, bytes_out = 0;  // of pixels
  std::uint64_t failed = 0;                   // tasks, as workers say
  bool operator==(const WorkCounts&) const = default;
};

class Coordinator {
 public:
  // `road` is borrowed and outlives the coordinator.
  Coordinator(Transport& road, const CoordinatorOptions& options);
  ~Coordinator();

  // Runs one job to its end. Throws what validate(job) throws.
  JobReport run(const Job& job, const JobWatcher& watcher = {});
  // Runs all frames to their ends, each told to watcher.finished. One that fails does not keep the others
  // from being done. Interrupted, it ends those under way and begins no more.
  void run(const Shot& shot, const JobWatcher& watcher);

  // A shot to work on beside the others, until over(). `keeper` is borrowed until then; null: nothing is
  // kept. Throws what validate(shot) throws.
  ShotId begin(Shot shot, const Standing& standing, JobWatcher watcher, Keeper* keeper = nullptr);
  bool over(ShotId shot) const { return !runs_.contains(shot); }
  // Ends the frames under way with the images of their last looks, and begins no more of them; or drops them,
  // and tells nobody.
  void interrupt(ShotId shot);
  void drop(ShotId shot);
  // No more tasks are given out, none is taken back. One that is over stays so.
  void pause(ShotId shot);
  void resume(ShotId shot);
  void set_standing(ShotId shot, const Standing& standing);
  Progress progress(ShotId shot) const;
  // How each of its frames under way stands.
  struct FrameNow {
    const FrameUnderWay* state = nullptr;  // until the next turn
    double seconds = 0;
  };
  std::map<std::size_t, FrameNow> frames(ShotId shot) const;

  // Has a task done again. Waits for a worker that may, as long as it takes.
  void check(Check check);

  // Reads mail until there is none and `until` has come, or wake(), decides, and tells the watchers.
  void turn(Instant until);
  void wake() { road_.wake(); }  // from any thread
  // Questions that wait for an answer may have one.
  void news() { held_.news(); }

  const Scheduler& scheduler() const { return scheduler_; }
  const std::map<WorkerId, WorkerRecord>& workers() const { return workers_; }
  const WorkCounts& counts() const { return counts_; }
  void release(const std::string& worker);  // one that was set aside

  // From any thread: end all frames under way with the images of their last looks; fail them; hand their
  // state to the watchers.
  void interrupt();
  void fail(const std::string& reason);
  void request_snapshot();

 private:
  struct Run {
    ShotPlan plan;
    Standing standing;
    JobWatcher watcher;
    Keeper* keeper = nullptr;
    Instant begun, next_progress;
    bool paused = false;
  };
  // A frame under way.
  struct Active {
    JobId id;
    ShotId shot;
    std::size_t place;  // in the shot
    Instant started;    // as if it had been worked on all the time
    FrameUnderWay state;
    std::set<WorkerId> offered = {};  // workers that were told of the job
    std::optional<std::string> failure = {};
    bool bad_input = false;
    bool interrupted = false;

    Frame& frame() { return *state.frame; }
    const Frame& frame() const { return *state.frame; }
    bool over() const { return failure.has_value() || frame().stopped(); }
  };

  void hear(Mail mail, Instant now);
  void hear_worker(const WorkerId& from, Message& message, Instant now);
  void tell(const Event& event, Instant now);
  void carry_out(const AssignTask&, Instant now);
  void carry_out(const RevokeTask&, Instant now);
  void carry_out(const Accept&, Instant now);
  void carry_out(const GiveUp&, Instant now);
  void carry_out(const Forget&, Instant now);
  void carry_out(const AskHello&, Instant now);
  void carry_out(const SetAside&, Instant now);
  void carry_out(const ClassChanged&, Instant now);
  void welcome(const WorkerId& from, const Hello& hello, Instant now);
  void leave(const WorkerId& from, Instant now);
  void answer(const WorkerId& from, const NeedJob& need, Instant now);
  void answer(const WorkerId& from, Ask ask, const Identity& who, Instant now);
  void answer_at_once(const HeldQuestion& question);
  void answer_held(Instant now);
  template <class Result>
  void take(const WorkerId& from, Result& result, Instant now);
  void failed(const WorkerId& from, TaskFailed& message, Instant now);
  bool fits(const RenderDone& result) const;
  bool fits(const FilterDone& result) const;

  // In checks.cpp: false, if the task belongs to no check.
  bool assign_check(const AssignTask&);
  bool accept_check(const Accept&, Instant now);
  bool give_up_check(const GiveUp&, Instant now);
  void end_check(TaskId task, const CheckResult& result, Instant now);

  void begin_frames(Instant now);
  void begin_frame(ShotId shot, Run& run, const ShotPlan::Start& start, Instant now);
  void end_frames(Instant now);
  void end_runs();
  void hand_on(Active ended, Instant now);
  void remember(Active& active, const std::shared_ptr<const Image>& history, Instant now);
  void add(Active& active, const std::vector<Work>& work, Instant now);
  void advance(Active& active, Instant now);
  void show(Instant now, bool one_ended);
  void dismiss(const Active& active, Instant now);
  // `stranger`, if it is not known (any more).
  WorkerRecord& record_of(const WorkerId& worker, WorkerRecord& stranger);
  void note(const Active& active, const std::string& text) const;
  const Run& run_of(const Active& active) const { return runs_.at(active.shot); }
  Standing standing_of(const Active& active) const;
  Wish wish_of(const Active& active, TaskId id, const Work& work) const;
  Active* active_of(JobId job);
  Instant next_wake(Instant now) const;
  Progress progress(ShotId shot, const Run& run, Instant now) const;
  // Of one that has ended, with its film; of one under way, with copies.
  static JobReport report(Active&& active, Instant now);
  static JobReport report(const Active& active, Instant now);
  static JobReport report(const Active& active, FrameImage image, Instant now);

  Transport& road_;
  CoordinatorOptions options_;
  Scheduler scheduler_;
  std::map<ShotId, Run> runs_;
  std::map<JobId, Active> active_;          // frames under way, in the order in which they began
  std::unordered_map<TaskId, Task> tasks_;  // of them, not accepted yet
  struct OpenCheck {
    JobId job = 0;
    Check check;
  };
  std::map<TaskId, OpenCheck> checks_;
  // The result being decided on, and whose it is.
  std::variant<std::monostate, RenderDone*, FilterDone*> in_hand_;
  WorkerId in_hand_from_;
  ShotId next_shot_ = 1;
  JobId next_job_;
  TaskId next_task_;
  std::map<WorkerId, WorkerRecord> workers_;
  HeldQuestions held_;
  WorkCounts counts_;
  std::atomic<bool> interrupted_ = false, snapshot_wanted_ = false;
  std::mutex failing_;  // guards failure_
  std::optional<std::string> failure_;
};

}  // namespace tessera
