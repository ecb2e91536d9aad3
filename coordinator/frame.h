// SPDX-License-Identifier: Apache-2.0
// One frame on its way to its image: what work there is to do, what comes of it, and when it is done. No
// sockets, threads or clocks; who does the work is the scheduler's matter. There are two kinds: frames that
// are rendered (rendered_frame.h), and those that are given and only filtered (given_frame.h). A coordinator
// does not know which it has.
//
//   begin() ─► render tasks ─► fold() ─► filter tasks ─► stitch() ─► round_complete() ─► look() ─► next
//   tasks, or stop
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "coordinator/progress.h"
#include "core/acceptance.h"
#include "core/film.h"
#include "core/frame_snapshot.h"
#include "core/job.h"
#include "core/plan.h"
#include "core/task.h"

namespace tessera {

// The image a user gets, and what is known of it: the state at the last look.
struct FrameImage {
  Image filtered;  // RGB
  // Of a frame that was rendered; else empty.
  Image sums;  // film sums as they are now, laid out by `layout`
  FilmLayout layout{AovSet{}};
  std::vector<Region> cells;
  std::vector<CellState> states;  // per cell; empty before the first look
  ErrorEstimate error;            // of the frame
  double acceptable_share = 0;    // of the cells
  std::optional<StopReason> stop;
  int rounds = 0;  // looks taken
  std::int64_t pixel_samples = 0;
};

class Frame {
 public:
  Frame(const Frame&) = delete;
  Frame& operator=(const Frame&) = delete;
  virtual ~Frame() = default;

  const Job& job() const { return job_; }

  // The first round's work.
  virtual std::vector<Work> begin() = 0;
  // Take a result of a task of this round; a repeat changes nothing. fold() returns the filter tasks that it
  // made ready.
  virtual std::vector<Work> fold(Block block) = 0;
  virtual void stitch(const FilterTask& task, const Filtered& filtered) = 0;

  // What the frame before kept; null: nothing (the shot begins here, or was cut). Once, if it was awaited.
  // Returns the filter tasks that only waited for this.
  std::vector<Work> remember(std::shared_ptr<const Image> history);
  bool awaits_history() const { return awaits_history_; }
  bool continued() const { return history_ != nullptr; }
  // What this frame keeps for the next one: filter_shape().kept planes over the frame. Precondition:
  // stopped(), and the filter keeps something.
  virtual std::shared_ptr<const Image> kept() const = 0;

  virtual bool round_complete() const = 0;  // and not stopped
  // Decides at the end of a round: the next round's work, or nothing once stopped().
  virtual std::vector<Work> look(const Budget& budget) = 0;
  // Ends the frame with the image of the last look; before the first one it is noisy where nothing is known.
  virtual void stop(StopReason reason) = 0;
  virtual bool stopped() const = 0;

  // What a filter task needs: of the history, what its pixels can touch.
  FilterInput filter_input(const FilterTask& task) const;
  // What a worker's answer to a task of this frame must look like.
  virtual bool fits(const RenderTask& task, const Block& block) const = 0;
  bool fits(const FilterTask& task, const Filtered& filtered) const;

  // All that it is at the begin of a round, but for what it was given. Precondition: a round has begun, by
  // begin() or look(), and no result of it was taken yet.
  virtual FrameSnapshot snapshot() const = 0;
  // The work of this round that can be done now, and is not in.
  virtual std::vector<Work> outstanding() const = 0;

  virtual FrameImage image() const& = 0;
  virtual FrameImage image() && { return std::as_const(*this).image(); }  // with what it need not copy
  // RGB as well as it is known now, for people to watch.
  virtual Image preview() const = 0;
  virtual Progress progress(double seconds) const = 0;
  virtual int round() const = 0;  // under way, from 1
  // Of frames that are rendered: whether there was a look; cells in a row; how they stood at the last look.
  virtual bool seen() const { return false; }
  virtual int columns() const { return 0; }
  virtual std::span<const CellState> cell_states() const { return {}; }

 protected:
  // `awaits_history`: nothing is filtered before remember().
  Frame(const Job& job, bool awaits_history) : job_(job), awaits_history_(awaits_history) {}

  // What of these filter tasks, which only lack the history, can be done now.
  std::vector<Work> ready(std::vector<Work> tasks);
  // The planes of a filter task over its outer region; and those of the motion there.
  virtual Image taken(const Region& outer) const = 0;
  virtual Image motion(const Image& taken) const = 0;

 private:
  Job job_;
  bool awaits_history_;
  std::vector<Work> waiting_;             // for the history
  std::shared_ptr<const Image> history_;  // of the frame before; may be null
};

// What comes to a frame that is given: the planes of its filter over its region. Null: of one that is
// rendered.
using Planes = std::shared_ptr<const Image>;

// A frame that awaits its history: at its begin, or as it was when the snapshot was taken. Throws InputError
// unless the snapshot is one of this job's.
std::unique_ptr<Frame> make_frame(const Job& job, Planes planes = nullptr);
std::unique_ptr<Frame> make_frame(const Job& job, FrameSnapshot snapshot, Planes planes = nullptr);

// What a frame of the job will hold in memory, at the most.
double frame_bytes(const Job& job);

}  // namespace tessera
