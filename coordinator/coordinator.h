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
#include <unordered_map>
#include <variant>

#include "coordinator/frame.h"
#include "coordinator/progress.h"
#include "coordinator/scheduler.h"
#include "coordinator/shot.h"
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
  std::shared_ptr<const Image> kept;     // for the next frame, see Frame::kept(); null: nothing
  bool continued = false;                // it went by what the frame before has kept
};

struct JobWatcher {
  ProgressSink progress = {};  // called whenever something changed, but not more often than
  Millis interval{0};          // this
  // Called after request_snapshot(), for each frame under way: its place in the shot, and how it stands.
  std::function<void(std::size_t frame, const JobReport&)> snapshot = {};
  // Called when a frame has ended; workers go on meanwhile. Frames may end out of order, unless each needs
  // what the one before has kept.
  std::function<void(std::size_t frame, const JobReport&)> finished = {};
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

  // From any thread: end the frames under way with the images of their last looks; fail them; hand their
  // state to the watcher.
  void interrupt();
  void fail(const std::string& reason);
  void request_snapshot();

 private:
  // A frame under way.
  struct Active {
    Active(JobId job_id, const Job& job, const ShotPlan::Start& start, Instant now);

    JobId id;
    std::size_t place;  // in the shot
    Instant started;
    Frame frame;
    std::set<WorkerId> offered;  // workers that were told of the job
    std::uint64_t dropped = 0;
    std::set<std::string> device_classes;
    std::optional<std::string> failure;
    bool bad_input = false;

    bool over() const { return failure.has_value() || frame.stopped(); }
  };

  void hear(Mail mail, Instant now);
  void tell(const Event& event, Instant now);
  void carry_out(const AssignTask&, Instant now);
  void carry_out(const RevokeTask&, Instant now);
  void carry_out(const Accept&, Instant now);
  void carry_out(const GiveUp&, Instant now);
  void carry_out(const Forget&, Instant now);
  void carry_out(const AskHello&, Instant now);
  void carry_out(const ClassChanged&, Instant now);
  void carry_out(const SetAside&, Instant now);
  void welcome(const WorkerId& from, const Hello& hello, Instant now);
  void answer(const WorkerId& from, const NeedJob& need, Instant now);
  template <class Result>
  void take(const WorkerId& from, Result& result, Instant now);
  bool fits(const RenderDone& result) const;
  bool fits(const FilterDone& result) const;

  void begin_frames(Instant now);
  void end_frames(Instant now);
  void hand_on(const Active& ended, Instant now);
  void add(Active& active, const std::vector<Work>& work, Instant now);
  void advance(Active& active, Instant now);
  void dismiss(const Active& active, Instant now);
  Active* active_of(JobId job);
  Instant next_wake(Instant now) const;
  Progress progress(Instant now) const;
  static JobReport report(const Active& active, Instant now);

  Transport& road_;
  CoordinatorOptions options_;
  Scheduler scheduler_;
  ShotPlan shot_;
  const JobWatcher* watcher_ = nullptr;     // of the run under way
  Instant begun_{};                         // the run
  std::map<JobId, Active> active_;          // frames under way, in the order of the shot
  std::unordered_map<TaskId, Task> tasks_;  // of them, not accepted yet
  // The result being decided on, and whose it is.
  std::variant<std::monostate, RenderDone*, FilterDone*> in_hand_;
  WorkerId in_hand_from_;
  JobId next_job_;
  TaskId next_task_;
  std::map<WorkerId, std::string> device_classes_;
  std::atomic<bool> interrupted_ = false, snapshot_wanted_ = false;
  std::mutex failing_;  // guards failure_
  std::optional<std::string> failure_;
};

}  // namespace tessera
