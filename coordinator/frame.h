// SPDX-License-Identifier: Apache-2.0
// One frame from its first sample to the image that is good enough: folds blocks, stitches filtered tiles,
// looks at the error when a round is complete, and says what work comes next. No sockets, threads or clocks;
// who does the work is the scheduler's matter.
//
//   begin() ─► render tasks ─► fold() ─► filter tasks ─► stitch() ─► round_complete() ─► look() ─► next
//   tasks, or stop
#pragma once

#include <map>
#include <memory>
#include <optional>
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
  Image sums;      // film sums as they are now, laid out by `layout`
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
  // `awaits_history`: nothing is filtered before remember().
  explicit Frame(const Job& job, bool awaits_history = false);

  // As it was when the snapshot was taken: a round has begun. It awaits its history, whether it had it then
  // or not. Throws InputError unless the snapshot is one of this job's.
  Frame(const Job& job, FrameSnapshot snapshot);

  // What it will hold in memory, at the most.
  static double bytes(const Job& job);

  // The first round's work.
  std::vector<Work> begin();
  // Take a result of a task of this round; a repeat changes nothing. fold() returns the filter tasks that it
  // made ready.
  std::vector<Work> fold(Block block);
  void stitch(const FilterTask& task, const Filtered& filtered);

  // What the frame before kept; null: nothing (the shot begins here, or was cut). Once, if it was awaited.
  // Returns the filter tasks that only waited for this.
  std::vector<Work> remember(std::shared_ptr<const Image> history);
  bool awaits_history() const { return awaits_history_; }
  bool continued() const { return history_ != nullptr; }
  // What this frame keeps for the next one: history_planes() over the frame. Precondition: stopped(), and the
  // filter keeps something.
  std::shared_ptr<const Image> kept() const;

  bool round_complete() const { return tiles_left_ == 0 && !stopped(); }
  // Decides at the end of a round: the next round's work, or nothing once stopped().
  std::vector<Work> look(const Budget& budget);
  // Ends the frame with the image of the last look (the noisy film, if there was none).
  void stop(StopReason reason);
  bool stopped() const { return decision_.stop.has_value(); }

  const Job& job() const { return job_; }
  const FilmLayout& layout() const { return film_.layout(); }
  // What a filter task needs: of the history, what its pixels can touch.
  FilterInput filter_input(const FilterTask& task) const;
  // What a worker's answer to a task of this frame must look like.
  bool fits(const RenderTask& task, const Block& block) const;
  bool fits(const FilterTask& task, const Filtered& filtered) const;

  // All that it is at the begin of a round. Precondition: a round has begun, by begin() or look(), and no
  // result of it was taken yet.
  FrameSnapshot snapshot() const;
  // The work of this round that can be done now, and is not in.
  std::vector<Work> outstanding() const;

  FrameImage image() const&;
  FrameImage image() &&;  // with the film itself
  // RGB as well as it is known now, for people to watch: this round's filtered tiles, elsewhere the image of
  // the last look; before the first one the noisy film, black where it has no samples.
  Image preview() const;
  Progress progress(double seconds) const;
  bool seen() const { return looks_taken_ > 0; }
  int round() const { return round_; }                                           // under way, from 1
  int columns() const { return columns_; }                                       // of cells
  const std::vector<CellState>& cell_states() const { return decision_.cells; }  // at the last look

 private:
  FrameImage image(Image sums) const;
  std::vector<Work> start_round(const std::vector<int>& want);
  std::vector<Work> cell_done(std::size_t cell);
  void keep_seen();
  CellLook look_at(std::size_t cell) const;
  std::optional<ErrorEstimate> hold_out(std::size_t cell, const Image& weight) const;
  std::size_t cell_at(int x, int y) const;
  double samples_after_this_round() const;

  Job job_;
  std::vector<Region> cells_;
  int columns_ = 0;
  std::vector<Tile> tiles_;
  std::map<Region, std::size_t> tile_at_;  // by inner region

  Film film_;
  bool awaits_history_;
  std::vector<Work> waiting_;             // for the history
  std::shared_ptr<const Image> history_;  // of the frame before; may be null
  Image stitched_;   // filtered_planes() over the frame, this round's tiles replacing older ones
  Image seen_;       // RGB delivered at the last look
  Image seen_sums_;  // colour sums of the halves and their counts at the last look

  int round_ = 0;  // number of the round under way, from 1
  int looks_taken_ = 0;
  std::vector<int> have_, want_;                         // samples of each cell before and after this round
  std::vector<std::vector<std::size_t>> tiles_of_cell_;  // tiles whose outer region the cell touches
  std::vector<int>
      cells_left_;  // of each tile, cells of this round that it still waits for; -1: not in this round
  std::vector<bool> cell_open_;                        // cells of this round that are not complete
  int tiles_round_ = 0, tiles_left_ = 0;               // of this round; of them, not stitched yet
  std::int64_t samples_done_ = 0, samples_round_ = 0;  // see Progress
  std::vector<bool> tile_stitched_;
  std::vector<bool> cell_changed_;  // pixels that its error depends on were stitched in this round
  std::vector<CellLook> looks_;
  Decision decision_;
};

}  // namespace tessera
